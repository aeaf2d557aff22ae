# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Samples stacked into arrays and back."""

from __future__ import annotations

from math import nan

from contact_estimation.exceptions import SignalShapeError
from contact_estimation.signals.contact_sample import ContactRecording, ContactSample
import numpy as np
import pytest

SAMPLES = [ContactSample(10**18 + 2_000_000 * k, 0.1 * k, 0.2 * k, -k) for k in range(5)]


def test_samples_survive_the_arrays() -> None:
    assert list(ContactRecording.of(SAMPLES)) == SAMPLES


def test_samples_come_back_as_plain_numbers() -> None:
    (first, *_) = ContactRecording.of(SAMPLES)
    assert [type(value) for value in first] == [int, float, float, float]


def test_unknown_velocity_stays_unknown() -> None:
    (sample,) = ContactRecording.of([ContactSample(0, 0.0, nan, 0.0)])
    assert np.isnan(sample.velocity)


def test_time_counts_from_the_first_stamp() -> None:
    np.testing.assert_allclose(ContactRecording.of(SAMPLES).t, 0.002 * np.arange(5), rtol=1e-12)


def test_empty_recording_has_no_samples() -> None:
    recording = ContactRecording.of([])
    assert (len(recording), list(recording), len(recording.t)) == (0, [], 0)


@pytest.mark.parametrize('shape', [(4,), (5, 1), ()])
def test_arrays_of_other_shapes_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(SignalShapeError, match='one-dimensional and of one length'):
        ContactRecording(np.arange(5), np.zeros(shape), np.zeros(5), np.zeros(5))
