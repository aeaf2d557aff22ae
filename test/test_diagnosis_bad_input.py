# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings that tell nothing are refused with a reason; odd ones do no harm."""

from __future__ import annotations

from typing import Any

from concealed_worlds import diagnosed, recorded
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.exceptions import ContactEstimationError, RecordingError
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]


def changed(**rows: Any) -> Signals:
    """Change some of a recording's signals."""
    return recorded()._replace(**rows)


def refused(signals: Signals, match: str) -> None:
    """Require an error with a text."""
    with pytest.raises(RecordingError, match=match):
        diagnosed(signals)


@pytest.mark.slow
def test_constant_force_is_refused() -> None:
    refused(changed(force=np.full(1825, -3.0)), 'wrench is constant at -3.*topic, axis')


@pytest.mark.parametrize('row', ['force', 'position'])
@pytest.mark.parametrize('value', [np.nan, np.inf])
def test_signals_that_are_no_numbers_are_refused(row: str, value: float) -> None:
    values: Array = getattr(recorded(), row).copy()
    values[700] = value
    with pytest.raises(ContactEstimationError, match='finite'):
        diagnosed(changed(**{row: values}))
