# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings that tell nothing are refused with a reason; odd ones do no harm."""

from __future__ import annotations

from typing import Any

from concealed_worlds import diagnosed, nominal, recorded
from contact_estimation.diagnosis.conclude.diagnose import diagnose
from contact_estimation.diagnosis.observe.observed import observe
from contact_estimation.diagnosis.observe.signals import LEAST_SAMPLES, Recording, Signals
from contact_estimation.exceptions import ContactEstimationError, RecordingError
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]


def changed(**rows: Any) -> Signals:
    """Change some of a recording's signals."""
    return recorded()._replace(**rows)


def cut(signals: Signals, first: float, last: float) -> Signals:
    """Keep a stretch of a recording, its time beginning anew."""
    inside = (signals.wrench_t >= first) & (signals.wrench_t < last)
    t = signals.wrench_t[inside] - signals.wrench_t[inside][0]
    return Signals(t, signals.force[inside], t, signals.position[inside], t,
                   signals.reference[:, inside])


def refused(signals: Signals, match: str) -> None:
    """Require an error with a text."""
    with pytest.raises(RecordingError, match=match):
        diagnosed(signals)


@pytest.mark.slow
def test_constant_force_is_refused() -> None:
    refused(changed(force=np.full(1825, -3.0)), 'wrench is constant at -3.*topic, axis')


@pytest.mark.parametrize('count', [5, LEAST_SAMPLES - 1])
def test_recordings_of_few_samples_are_refused(count: int) -> None:
    few = cut(recorded(), 0.5, 0.498 + 0.004 * count)
    assert len(few.force) == count
    refused(few, f'wrench has {count} samples, expected at least 50')


def test_holdout_without_contact_is_named() -> None:
    away = changed(position=recorded().position - 0.05)
    found = diagnose(
        Recording('monday', recorded()), nominal(), held_out=[Recording('tuesday', away)])
    assert [one.text.split()[0] for one in found.checks if not one.ok] == ['tuesday:']


@pytest.mark.parametrize('row', ['force', 'position'])
@pytest.mark.parametrize('value', [np.nan, np.inf])
def test_signals_that_are_no_numbers_are_refused(row: str, value: float) -> None:
    values: Array = getattr(recorded(), row).copy()
    values[700] = value
    with pytest.raises(ContactEstimationError, match='finite'):
        diagnosed(changed(**{row: values}))


def test_lost_wrenches_keep_their_place() -> None:
    signals = recorded()
    kept = np.random.default_rng(1).uniform(size=len(signals.wrench_t)) > 0.1
    kept[[0, -1]] = True
    kept[900:1000] = False
    observed = observe(signals._replace(wrench_t=signals.wrench_t[kept],
                                        force=signals.force[kept]), nominal())
    np.testing.assert_array_equal(observed.measured, kept)
