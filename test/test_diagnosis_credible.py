# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Laws that are not credible whatever they fit."""

from __future__ import annotations

from typing import Callable

from concealed_worlds import diagnosed, named, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.fit.credible import is_credible, may_show
from contact_estimation.diagnosis.fit.fitting import Fit, fit
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.physics import EFFECTS
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

SPRING = nominal(environment__stiffness=1000.0, environment__damping=20.0,
                 environment__unilateral=False)
T = np.arange(3000) / 200.0
ONE_HOLD = 0.01 * np.clip(T / 2.0, 0.0, 1.0)
TO_AND_FRO = 0.005 * np.sin(1.9 * T) + 0.004 * np.sin(4.4 * T)


def specimen(x: Array, stray: Array | float) -> Signals:
    """Record an attached specimen whose force also strays [N]."""
    force = 1000.0 * x + 5.0 * np.gradient(x, T) + stray
    noise = np.random.default_rng(4).normal(0.0, 0.01, len(T))
    return Signals(T, noise - force, T, x, np.empty(0), np.empty((4, 0)))


def prepared(signals: Signals) -> tuple[PreparedRecording, Fit]:
    """Recalibrate the spring."""
    recording, model = prepared_from(signals, SPRING)
    return recording, fit([recording], model)


def test_a_friction_that_never_slips_is_a_spring() -> None:
    recording, found = prepared(specimen(TO_AND_FRO, 0.0))
    reach = float(np.ptp(recording.observed.force))
    for share, credible in ((1.4, True), (1.6, False)):
        model = found.model.with_effect('presliding_friction', (share * reach, 500.0))
        assert is_credible([recording], model) is credible


@pytest.mark.parametrize('frequency, credible', [
    (0.06, False), (0.07, True), (24.0, True), (26.0, False)])
def test_a_resonance_needs_one_period_and_eight_samples_in_it(
    frequency: float, credible: bool
) -> None:
    recording, found = prepared(specimen(TO_AND_FRO, 0.0))
    model = found.model.with_effect('environment_resonance', (0.1, frequency, 0.05))
    assert is_credible([recording], model) is credible


def test_a_damping_that_differs_drives_no_direction() -> None:
    recording, model = prepared_from(recorded())
    for share, credible in ((-1.05, True), (1.15, False), (-1.15, False)):
        driven = model.with_effect('asymmetric_damping', (share * model.damping,))
        assert is_credible([recording], driven) is credible


def test_a_play_within_the_noise_of_the_positions_is_none() -> None:
    recording, model = prepared_from(recorded())
    noise = recording.observed.position_noise
    for share, credible in ((1.9, False), (2.1, True)):
        playing = model.with_effect('backlash', (share * noise,))
        assert is_credible([recording], playing) is credible


def test_an_exponential_needs_a_motion_that_shows_more_than_a_parabola() -> None:
    recording, found = prepared(specimen(TO_AND_FRO, 0.0))
    reach = float(np.ptp(recording.observed.x))
    for share, credible in ((4.9, True), (5.1, False)):
        model = found.model.with_effect('exponential_stiffness', (1.0, share * reach))
        assert is_credible([recording], model) is credible


@pytest.mark.parametrize('effect, values, credible', [
    ('free_play', (0.002, 0.0005, 1.0), True),
    ('free_play', (0.002, -0.0095, 1.0), False),
    ('free_play', (161.0, -80.0, 1.0), False),
    ('bilinear_stiffness', (500.0, 0.003), True),
    ('bilinear_stiffness', (500.0, 0.03), False),
])
def test_the_motion_passes_every_depth_at_which_a_law_bends(
    effect: str, values: tuple[float, ...], credible: bool
) -> None:
    recording, model = prepared_from(recorded(environment__unilateral=False),
                                     nominal(environment__unilateral=False))
    least, most = np.quantile(recording.observed.x, (0.01, 0.99))
    assert -0.0105 < least < -0.001 and 0.004 < most < 0.03
    assert is_credible([recording], model.with_effect(effect, values)) is credible


@pytest.mark.parametrize('values, credible', [
    ((-4e-5, 1.02), False), ((0.0008, 1.0), True), ((1e-5, 0.94), True), ((-0.0005, 1.04), False)])
def test_a_sensor_within_its_calibration_has_no_characteristic_of_its_own(
    values: tuple[float, ...], credible: bool
) -> None:
    recording, model = prepared_from(recorded())
    assert 80.0 < float(np.max(np.abs(recording.observed.force))) < 100.0
    assert is_credible([recording], model.with_effect('force_nonlinearity', values)) is credible


@pytest.mark.parametrize('tau, credible', [(1.0, True), (1.9, True), (2.1, False)])
def test_a_zero_that_settles_long_after_the_end_is_none(tau: float, credible: bool) -> None:
    recording, model = prepared_from(recorded())
    values = (1.0, tau * float(recording.observed.t[-1]), 0.5)
    assert is_credible([recording], model.with_effect('settling_bias', values)) is credible


@pytest.mark.parametrize('offset, credible', [(0.1, True), (-0.1, True), (1.0, False),
                                              (-1.0, False)])
def test_a_surface_is_not_far_beyond_the_motion(offset: float, credible: bool) -> None:
    recording, model = prepared_from(recorded())
    assert 0.02 < float(np.ptp(recording.observed.x)) < 0.2
    offset_first = model.with_effect('contact_offset', (offset,)).with_effect(
        'coulomb_friction', (1.0,))
    assert may_show([recording], offset_first, 'contact_offset') is credible
    assert is_credible([recording], offset_first)


@pytest.mark.parametrize(
    'name', ['force_delay', 'command_delay', 'force_lag', 'actuator_lag'])
def test_a_delay_is_no_smaller_than_stamps_are_known(name: str) -> None:
    recording, model = prepared_from(recorded())
    for share, credible in ((0.04, False), (0.06, True)):
        delayed = model.with_effect(name, (share * recording.observed.h,))
        assert is_credible([recording], delayed) is credible


@pytest.mark.parametrize('slower, apart, credible', [
    (0.5, 0.06, False), (0.5, 0.07, True), (0.21, 0.3, True), (0.19, 0.3, False)])
def test_two_tones_have_periods_and_gain_one_on_one_another(
    slower: float, apart: float, credible: bool
) -> None:
    recording, found = prepared(specimen(TO_AND_FRO, 0.0))  # of 15 s
    tones = (1e-3, slower, 0.0, 1e-3, slower + apart, 0.0)
    model = found.model.with_effect('beating_environment', tones)
    assert is_credible([recording], model) is credible


def test_an_effect_that_vanishes_is_none() -> None:
    recording, found = prepared(specimen(TO_AND_FRO, 0.0))
    for name, values, credible in (
            ('coulomb_friction', (0.0,), False), ('coulomb_friction', (0.1,), True),
            ('stribeck_friction', (0.05, 0.1, 0.01), True),
            ('stribeck_friction', (0.0, 0.1, 0.01), False),
            ('power_law_stiffness', (1.0, 1000.0), False)):
        assert is_credible([recording], found.model.with_effect(name, values)) is credible


@pytest.mark.parametrize('x, stray, family', [
    (ONE_HOLD, -3.0 * (1.0 - np.exp(-np.maximum(T - 2.0, 0.0) / 3.0)), 'relaxation'),
    (TO_AND_FRO, 3.0 * np.exp(-T / 3.0), 'sensor_zero')], ids=['one hold', 'to and fro'])
def test_what_decays_is_the_specimen_where_it_is_loaded_once(
    x: Array, stray: Array, family: str
) -> None:
    assert {EFFECTS[name].family for name in named(diagnosed(specimen(x, stray), SPRING))} == {
        family}


@pytest.mark.parametrize('friction, names', [(0.02, []), (0.4, ['coulomb_friction'])])
def test_an_effect_that_noise_hides_gets_no_name(friction: float, names: list[str]) -> None:
    assert named(diagnosed(recorded(**physics('coulomb_friction', friction)))) == names


def test_a_presliding_friction_comes_near_its_end() -> None:
    recording, found = prepared(specimen(TO_AND_FRO, 0.0))
    reach = float(np.ptp(recording.observed.x))
    for travel, credible in ((3.0 * reach, True), (3.2 * reach, False)):  # ln 5 travel: 5 reach
        model = found.model.with_effect('presliding_friction', (0.1, 0.1 / travel))
        assert is_credible([recording], model) is credible


DRIVE = nominal(environment__stiffness=0.0, environment__damping=60.0,
                environment__unilateral=False)


def moved(force: Callable[[Array], Array]) -> PreparedRecording:
    """Record a drive that moves to and fro, with noise in the force."""
    t = np.arange(3000) / 250.0
    v = 0.5 * np.cos(1.7 * t) + 0.3 * np.cos(4.1 * t)
    x = 0.5 / 1.7 * np.sin(1.7 * t) + 0.3 / 4.1 * np.sin(4.1 * t)
    measured = -force(v) + np.random.default_rng(4).normal(0.0, 0.4, len(t))
    return prepared_from(Signals(t, measured, t, x, np.empty(0), np.empty((4, 0))), DRIVE)[0]


def test_a_force_held_most_of_the_time_to_and_fro_is_no_saturating_sensor() -> None:
    steep = Model.of(DRIVE).at((0.0, 1000.0)).with_effect('force_saturation', (8.0,))
    assert not is_credible([moved(lambda v: 8.0 * np.tanh(v / 0.01))], steep)
    gentle = Model.of(DRIVE).with_effect('force_saturation', (35.0,))
    assert is_credible([moved(lambda v: np.clip(60.0 * v, -35.0, 35.0))], gentle)


def test_a_force_that_is_level_since_the_depth_is_held_is_no_saturating_sensor() -> None:
    t = np.arange(3000) / 250.0
    x = 0.01 * np.clip(np.interp(t, [0.0, 1.0, 2.0, 6.0, 7.0, 12.0], [0, 0, 1, 1, 0.4, 0.4]), 0, 1)
    force = -1000.0 * x + np.random.default_rng(4).normal(0.0, 0.05, len(t))
    spring = nominal(environment__stiffness=1000.0, environment__damping=1.0,
                     environment__unilateral=False)
    held, start = prepared_from(Signals(t, force, t, x, np.empty(0), np.empty((4, 0))), spring)
    assert not is_credible([held], start.with_effect('force_saturation', (9.98,)))


@pytest.mark.parametrize('name, values, clips', [
    ('force_saturation', (25.0,), True), ('bilinear_stiffness', (-4500.0, 0.003), False)])
def test_a_saturating_sensor_leaves_the_force_level_and_a_soft_wall_does_not(
    name: str, values: tuple[float, ...], clips: bool
) -> None:
    recording, model = prepared_from(recorded(**physics(name, *values)))
    base = fit([recording], model)
    found = fit([recording], base.model.with_effect('force_saturation', (25.0,)))
    assert is_credible([recording], found.model) is clips
