# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Samples stacked into arrays and back."""

from __future__ import annotations


from contact_estimation.exceptions import SignalShapeError
from contact_estimation.signals.contact_recording import ContactRecording
from contact_estimation.signals.contact_sample import ContactSample
import numpy as np
import pytest

SAMPLES = [ContactSample(10**18 + 2_000_000 * k, 0.1 * k, 0.2 * k, -k) for k in range(5)]


def test_samples_survive_the_arrays() -> None:
    assert list(ContactRecording.of(SAMPLES)) == SAMPLES


@pytest.mark.parametrize('shape', [(4,), (5, 1), ()])
def test_arrays_of_other_shapes_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(SignalShapeError, match='one-dimensional and of one length'):
        ContactRecording(np.arange(5), np.zeros(shape), np.zeros(5), np.zeros(5))
