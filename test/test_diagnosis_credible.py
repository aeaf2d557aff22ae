# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Laws that are not credible whatever they fit, and where a search for one starts."""

from __future__ import annotations

from concealed_worlds import diagnosed, named, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.conclude import naming as naming_module
from contact_estimation.diagnosis.conclude.apparent_mass import is_resonance
from contact_estimation.diagnosis.conclude.conclusion import _nominal_where_unknown
from contact_estimation.diagnosis.conclude.rivals import other_families
from contact_estimation.diagnosis.conclude.shares import Shares
from contact_estimation.diagnosis.fit.applicable import candidates_for, candidates_in
from contact_estimation.diagnosis.fit.first_step import steps
from contact_estimation.diagnosis.fit.fitting import Fit, fit, fit_at
from contact_estimation.diagnosis.fit.scales import measure_scales
from contact_estimation.diagnosis.fit.search import is_credible, may_show, search
from contact_estimation.diagnosis.fit.uncertainty import standard_deviations
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.physics import EFFECTS
from contact_estimation.plant.plant_parameters import PlantParameters
import numpy as np
from numpy.typing import NDArray
import pytest

SPRING = nominal(environment__stiffness=1000.0, environment__damping=20.0,
                 environment__unilateral=False)
T = np.arange(3000) / 200.0
ONE_HOLD = 0.01 * np.clip(T / 2.0, 0.0, 1.0)
TO_AND_FRO = 0.005 * np.sin(1.9 * T) + 0.004 * np.sin(4.4 * T)


def specimen(x: NDArray[np.float64], stray: NDArray[np.float64] | float) -> Signals:
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


@pytest.mark.parametrize('name', ['settling_bias', 'force_drift', 'stiffness_drift'])
@pytest.mark.parametrize('wall, with_robot', [(SPRING, False), (nominal(), False),
                                              (nominal(), True)])
def test_what_changes_with_time_is_no_candidate_where_a_wall_is_loaded_once(
    name: str, wall: PlantParameters, with_robot: bool
) -> None:
    assert name not in candidates_for(Model.of(wall), with_robot, returns=False)
    assert name in candidates_for(Model.of(wall), with_robot)


@pytest.mark.parametrize('family', ['damping_law', 'inertia'])
def test_no_law_of_speed_is_a_candidate_where_a_specimen_moves_at_one(family: str) -> None:
    laws = {name for name, cls in EFFECTS.items() if cls.family == family}
    assert not laws & set(candidates_for(Model.of(SPRING), False, paces=False))
    assert laws & set(candidates_for(Model.of(SPRING), False))
    triangle = 0.01 * np.abs((T / 3.0) % 2.0 - 1.0)
    for x, found in ((TO_AND_FRO, True), (triangle, False)):
        recording, base = prepared(specimen(x, 0.0))
        assert bool(laws & set(candidates_in([recording], base.model))) is found


@pytest.mark.parametrize('x, stray, family', [
    (ONE_HOLD, -3.0 * (1.0 - np.exp(-np.maximum(T - 2.0, 0.0) / 3.0)), 'relaxation'),
    (TO_AND_FRO, 3.0 * np.exp(-T / 3.0), 'sensor_zero')], ids=['one hold', 'to and fro'])
def test_what_decays_is_the_specimen_where_it_is_loaded_once(
    x: NDArray[np.float64], stray: NDArray[np.float64], family: str
) -> None:
    assert {EFFECTS[name].family for name in named(diagnosed(specimen(x, stray), SPRING))} == {
        family}


def test_the_search_finds_how_fast_a_zero_settles() -> None:
    # From the first start a step of all three values ends with a time constant of 1 ms.
    stray = 4.0 * np.exp(-T / 2.3) - 3.1
    recording, found = prepared(specimen(TO_AND_FRO + 0.006 * np.exp(-T / 5.0), stray))
    best = search([recording], found, lambda name: None, ['settling_bias'])[0].model
    change, tau, bias = best.values[best.place('settling_bias')]
    assert (-change, tau, -bias) == pytest.approx((4.0, 2.3, -3.1), rel=0.02)


def test_one_step_may_be_of_all_that_a_law_is_linear_in() -> None:
    recording, found = prepared(specimen(TO_AND_FRO, 4.0 * np.exp(-T / 2.3) - 3.1))
    start = found.model.with_effect('settling_bias', (0.02, 2.3, 0.0))
    step = steps([recording], [start])[0]
    cost, there = step.cost, step.model
    change, _, bias = there.values[there.place('settling_bias')]
    assert (-change, -bias) == pytest.approx((4.0, -3.1), rel=0.02)
    assert cost < 1.1 * fit([recording], start).cost


def test_two_tones_within_one_peak_of_the_spectrum_are_told_apart() -> None:
    swing = physics('beating_environment', 3e-4, 1.7, 0.7, 2.5e-4, 1.8, -0.5)
    recording, model = prepared_from(recorded(**swing))
    scales = measure_scales([recording], fit([recording], model))
    assert sorted(tone for tone, _ in scales.beat) == pytest.approx([1.7, 1.8], abs=0.03)
    assert sum(1.6 < tone < 1.9 for tone, _ in scales.peaks()) == 1


@pytest.mark.parametrize('sizes, agrees', [
    ((4.0, 5.0, 6.0), True), ((1.2, 1.4, 1.6), False), ((18.0, 20.0, 17.0), False),
    ((-4.0, -5.0, -6.0), False), ((1.0, 5.0, 40.0), True)])
def test_a_law_has_much_the_same_size_on_each_part_as_on_all(
    monkeypatch: pytest.MonkeyPatch, sizes: tuple[float, ...], agrees: bool
) -> None:
    assert agreeing(monkeypatch, sizes, (1.0, 1.0, 1.0)) is agrees


@pytest.mark.parametrize('told, agrees', [
    ((9.0, 9.0, 0.8, 0.8), True), ((9.0, 9.0, 1.0, 1.0), False), ((9.0, 0.8, 0.8, 0.8), False)])
def test_parts_that_do_not_determine_a_size_do_not_contradict_it(
    monkeypatch: pytest.MonkeyPatch, told: tuple[float, ...], agrees: bool
) -> None:
    assert agreeing(monkeypatch, (5.0, 6.0, -60.0, -60.0), told) is agrees


@pytest.mark.parametrize('name, first, agrees', [
    ('viscous_flow', 0.0, False), ('viscous_flow', 4.0, True), ('cubic_stiffness', 0.0, True)])
def test_what_every_contact_adds_to_shows_in_the_first(
    monkeypatch: pytest.MonkeyPatch, name: str, first: float, agrees: bool
) -> None:
    # A surface that shifts between two contacts has not flowed in the first.
    sizes = (first, 5.0, 5.0, 5.0)
    assert agreeing(monkeypatch, sizes, (1.0, 1.0, 1.0, 1.0), name) is agrees


def agreeing(
    monkeypatch: pytest.MonkeyPatch, sizes: tuple[float, ...], told: tuple[float, ...],
    name: str = 'cubic_stiffness',
) -> bool:
    """Return whether sizes of an effect of 5 agree, on parts that tell so much of it."""
    model = Model.of(SPRING).with_effect(name, (5.0,))
    monkeypatch.setattr(Shares, '_alone', [(1000.0, 20.0, size) for size in sizes])
    monkeypatch.setattr(Shares, '_information', np.outer(told, (1.0, 1.0, 1.0)))
    none = np.zeros((3, 2))
    shares = Shares([], [], none, Fit(model, 0.0, np.zeros(1), 1), none, {}, {}, {}, {})
    return shares.agrees(name)


@pytest.mark.parametrize('ringing', [False, True], ids=['mass', 'resonance'])
@pytest.mark.parametrize('name', ['tool_inertia', 'environment_inertia'])
def test_a_mass_that_vanishes_at_low_frequencies_is_a_resonance(name: str, ringing: bool) -> None:
    x = TO_AND_FRO + 0.002 * np.sin(9.7 * T)
    a = np.gradient(np.gradient(x, T), T)
    rate = np.gradient(np.gradient(a, T), T)
    rung = -4.0 / (2.0 * np.pi * 5.0)**2 * rate  # 4 kg on a mount that rings at 5 Hz
    recording, found = prepared(specimen(x, rung if ringing else 0.7 * a))
    model = fit([recording], found.model.with_effect(name, (0.5,))).model
    assert model.values[model.place(name).start] > 0.1
    assert is_resonance([recording], model, name) is ringing


def test_a_damping_that_a_hold_does_not_tell_stays_nominal() -> None:
    hold, found = prepared(specimen(0.01 + 1e-7 * np.sin(9.0 * T), 0.0))
    biased = found.model.with_effect('force_bias', (0.1,))
    lost = fit_at([hold], fit([hold], biased).model.at((1000.0, 500.0, 0.0)))
    assert standard_deviations([hold], lost)[1] > 20.0
    assert _nominal_where_unknown(Model.of(SPRING), [hold], lost).model.damping == 20.0
    told, of_motion = prepared(specimen(TO_AND_FRO, 0.0))
    moving = fit([told], of_motion.model.with_effect('coulomb_friction', (0.1,)))
    assert _nominal_where_unknown(Model.of(SPRING), [told], moving) is moving


def test_an_effect_smaller_than_the_noise_gets_no_name() -> None:
    assert named(diagnosed(recorded(**physics('coulomb_friction', 0.1)))) == []
    assert named(diagnosed(recorded(**physics('coulomb_friction', 0.4)))) == ['coulomb_friction']


def test_only_other_families_take_a_part_of_a_probability() -> None:
    recording, found = prepared(specimen(TO_AND_FRO, 0.0))
    rivals = [fit_at([recording], found.model.with_effect(name, values)) for name, values in (
        ('power_law_stiffness', (1.5, 2e4)), ('stribeck_friction', (1.0, 1.0, 0.01)),
        ('coulomb_friction', (1.0,)))]
    assert other_families('elastic_law', rivals) == {'friction'}
    assert other_families('friction', rivals[1:]) == set()


def test_a_name_that_is_unlikely_is_not_given(monkeypatch: pytest.MonkeyPatch) -> None:
    def doubted(shares: Shares, exact: bool) -> dict[str, float]:
        return dict.fromkeys(shares.of, 0.28)

    monkeypatch.setattr(naming_module, '_probabilities', doubted)
    diagnosis = diagnosed(recorded(**physics('coulomb_friction', 3.0)))
    assert (named(diagnosis), diagnosis.verdict) == ([], 'unexplained')


def test_a_presliding_friction_comes_near_its_end() -> None:
    recording, found = prepared(specimen(TO_AND_FRO, 0.0))
    reach = float(np.ptp(recording.observed.x))
    for travel, credible in ((3.0 * reach, True), (3.2 * reach, False)):  # ln 5 travel: 5 reach
        model = found.model.with_effect('presliding_friction', (0.1, 0.1 / travel))
        assert is_credible([recording], model) is credible
