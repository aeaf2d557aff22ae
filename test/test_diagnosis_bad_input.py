# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings that tell nothing are refused with a reason; odd ones do no harm."""

from __future__ import annotations

from typing import Any

from concealed_worlds import diagnosed, nominal, physics, recorded, touches
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


@pytest.mark.slow
def test_constant_position_is_refused() -> None:
    refused(changed(position=np.zeros(1825)), 'joint_states is constant at 0.*topic, axis')


def test_impossible_values_are_refused() -> None:
    force = recorded().force.copy()
    force[[7, 300]] = 1e300
    refused(changed(force=force), 'wrench must have possible values only, got 2 beyond 1e.30')


@pytest.mark.parametrize('count', [5, LEAST_SAMPLES - 1])
def test_recordings_of_few_samples_are_refused(count: int) -> None:
    few = cut(recorded(), 0.5, 0.498 + 0.004 * count)
    assert len(few.force) == count
    refused(few, f'wrench has {count} samples, expected at least 50')


@pytest.mark.parametrize('count', [0, 1])
def test_hardly_any_joint_state_is_refused(count: int) -> None:
    few = changed(joint_t=np.arange(float(count)), position=np.arange(float(count)))
    refused(few, f'joint_states has {count} samples')


def test_hardly_any_wrench_is_refused() -> None:
    refused(changed(wrench_t=np.zeros(1), force=np.zeros(1)), 'wrench has 1 samples')


def test_recording_without_contact_at_the_wall_gets_no_names() -> None:
    away = changed(position=recorded().position - 0.05)
    found = diagnose(Recording('monday', away), nominal())
    assert (found.verdict, found.refused) == ('unexplained', True)
    assert [one.name for one in found.checks if not one.ok] == ['wall_location']


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


@pytest.mark.slow
def test_one_touch_is_enough() -> None:
    once = touches((0.03, 1.5))
    found = diagnosed(recorded(once, **physics('coulomb_friction', 2.0)))
    assert [effect.name for effect in found.effects] == ['coulomb_friction']


@pytest.mark.slow
def test_recording_that_ends_in_contact_is_diagnosed() -> None:
    assert diagnosed(cut(recorded(), 0.0, 6.4)).verdict == 'consistent'


def test_grid_is_that_of_the_wrenches() -> None:
    signals = recorded()
    observed = observe(signals, nominal())
    np.testing.assert_allclose(observed.t, signals.wrench_t, atol=1e-9)
    assert observed.h == pytest.approx(0.004)


def test_lost_wrenches_keep_their_place() -> None:
    signals = recorded()
    kept = np.random.default_rng(1).uniform(size=len(signals.wrench_t)) > 0.1
    kept[[0, -1]] = True
    kept[900:1000] = False
    observed = observe(signals._replace(wrench_t=signals.wrench_t[kept],
                                        force=signals.force[kept]), nominal())
    np.testing.assert_array_equal(observed.measured, kept)


def test_jitter_of_stamps_moves_no_sample() -> None:
    signals = recorded()
    jitter = 2e-4 * np.random.default_rng(1).uniform(-1.0, 1.0, len(signals.wrench_t))
    jitter[0] = jitter[-1] = 0.0
    observed = observe(signals._replace(wrench_t=signals.wrench_t + jitter), nominal())
    assert len(observed.t) == len(signals.wrench_t)
    assert observed.measured.all()


def slow_ramp(sign: float) -> Signals:
    """Press and release an elastic wall once in 30 s, without a robot; sign that of x."""
    t = np.arange(1500) / 50.0
    x = np.interp(t, (0.0, 9.0, 18.0, 24.0, 30.0), (-8e-4, -8e-4, 4e-3, 4e-3, -8e-4))
    d = np.maximum(x, 0.0)
    noise = np.random.default_rng(1).standard_normal((2, len(t)))
    force = -(800.0 * d + 3e5 * d**2)
    return Signals(t, force + 0.08 * noise[0], t, sign * x + 1e-7 * noise[1], np.empty(0),
                   np.empty((4, 0)))


@pytest.mark.slow
@pytest.mark.filterwarnings('error')
@pytest.mark.parametrize('sign, location', [(1.0, 0.0), (-1.0, -0.002)])
def test_slow_ramp_is_diagnosed_without_numerical_warnings(sign: float, location: float) -> None:
    wall = {'environment__stiffness': 800.0, 'environment__damping': 10.0,
            'environment__location': location}
    assert diagnosed(slow_ramp(sign), nominal(**wall)).verdict != 'consistent'
