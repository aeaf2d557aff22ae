# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Every effect of wall and sensor against an independent formula, and against the plant."""

from __future__ import annotations

import math
from typing import Any

from contact_estimation.physics import EFFECTS
from contact_estimation.physics.backlash import played
from contact_estimation.physics.contact_effect import ContactEffect
from contact_estimation.physics.contact_law import ContactLaw
from contact_estimation.physics.force_sensor_effect import ForceSensorEffect
from contact_estimation.physics.robot_law import RobotLaw
from effect_examples import example, example_values
from effect_formulas import Array, between_stops, FORMULAS, SENSED
import numpy as np
import pytest
from world_reference import B_e, B_t, K_e, K_t, M_t, reference_at, simulate, with_effect

WALL = [name for name, cls in EFFECTS.items() if cls.port == 'contact']
SENSOR = [name for name, cls in EFFECTS.items() if cls.port == 'force_sensor']
ROBOT = [name for name, cls in EFFECTS.items()
         if cls.port == 'robot' and name != 'joint_flexibility']  # test_diagnosis_link.py
STATEFUL = [name for name in WALL if example(name).states]


def motion(h: float) -> tuple[Any, Any, Any, Any]:
    """Move into the wall and out of it, twice: time, position and derivatives."""
    t = h * np.arange(round(1.8 / h))
    x, v, a = (-0.012 * 9.0**n * np.cos(9.0 * t + 0.5 * n * np.pi) for n in range(3))
    return t, 0.006 + x, v, a


def law_of(name: str, unilateral: bool = True) -> ContactLaw:
    """Give the wall of the tests an effect."""
    return ContactLaw(K_e, B_e, 0.0, 0.0, unilateral, [example(name)])


def instants(count: int) -> Any:
    """Give times 2 ms apart [s]."""
    return 0.002 * np.arange(count)


def near_switch(force: Array, margin: int) -> Any:
    """Flag the samples near a touch-down or release."""
    edges = np.abs(np.diff((force != 0.0).astype(float), prepend=float(force[0] != 0.0)))
    return np.convolve(edges, np.ones(2 * margin + 1), 'same') > 0.0


def truths_of(name: str, count: int = 700, **values: Any) -> tuple[Array, ...]:
    """Simulate with an effect; rows are the fields of Truth."""
    return tuple(np.array(simulate(count, with_effect(name, **values))).T)


@pytest.fixture
def exact_positions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the play of backlash trust positions, which are free of noise here."""
    monkeypatch.setattr('contact_estimation.physics.backlash.POSITION_TOLERANCE', 0.0)


def test_backlash_on_arrays_holds_on_while_a_position_is_off_by_its_noise() -> None:
    t = np.arange(100, dtype=np.float64) * 2e-3
    x = np.linspace(-1e-3, 2e-3, 100)
    x[-1] -= 4e-6
    force = law_of('backlash').force(t, x, np.full(100, 0.015), np.zeros(100))
    assert force[-1] == pytest.approx(force[-2], rel=0.05)


@pytest.mark.parametrize('name', WALL)
@pytest.mark.usefixtures('exact_positions')
def test_law_on_arrays_is_the_contract_s_formula(name: str) -> None:
    t, x, v, a = motion(2e-5)
    expected = FORMULAS[name](t, x, v, a, *example_values(name))
    got = law_of(name).force(t, x, v, a)
    assert np.max(np.abs(expected)) > 20.0
    away = ~near_switch(expected, 2)
    assert np.mean(away) > 0.999
    np.testing.assert_allclose(
        got[away], expected[away], atol=0.02 if name in STATEFUL else 1e-9)


@pytest.mark.parametrize('name', sorted(set(STATEFUL) - {'fractional_relaxation'}))
def test_states_of_a_recording_are_those_of_small_steps(name: str) -> None:
    effect = example(name)
    t, d, v, _ = motion(2e-4)
    expected = ContactEffect.states_along(effect, t, d, v, d > 0.0)[:, ::10]
    t, d, v, _ = motion(2e-3)
    got = effect.states_along(t, d, v, d > 0.0)
    scale = np.max(np.abs(expected))
    apart = np.abs(got - expected) > 0.01 * scale
    assert scale > 0.0 and np.mean(apart) < 0.01  # a state may jump within a sample


def test_branches_solved_by_blocks_give_the_force_of_small_steps() -> None:
    effect = example('fractional_relaxation')
    t, d, v, _ = motion(2e-4)
    states = ContactEffect.states_along(effect, t, d, v, d > 0.0)[:, ::10].T
    t, d, v, _ = motion(2e-3)
    expected = [effect.resistance(*now, tuple(state), math)
                for *now, state in zip(t, d, v, states)]
    got = effect.resistance(t, d, v, effect.states_along(t, d, v, d > 0.0), np)
    scale = np.max(np.abs(expected))
    assert scale > 0.0 and np.mean(np.abs(got - expected) > 0.01 * scale) < 0.01


def test_play_of_an_attached_wall_has_an_end_on_either_side() -> None:
    t, x, v, a = motion(2e-3)
    gap, centre, beside = example_values('free_play')
    assert np.min(x) < centre - gap and np.max(x) > centre + gap
    got = law_of('free_play', unilateral=False).force(t, x, v, a)
    np.testing.assert_allclose(got, -between_stops(x, v, gap, centre, beside), atol=1e-9)


@pytest.mark.parametrize('name', WALL)
@pytest.mark.usefixtures('exact_positions')
def test_force_predicted_from_true_motion_is_the_true_force(name: str) -> None:
    t, x, v, a, force, _ = truths_of(name)
    got = law_of(name).force(t, x, v, a)
    away = ~near_switch(force, 1)
    if name == 'backlash':  # where the tool turns, its law switches without end
        away &= np.abs(v) > 1e-3
    assert np.max(-force) > 10.0 and np.mean(away) > 0.9
    np.testing.assert_allclose(got[away], force[away], atol=PREDICTION.get(name, 1e-9))


PREDICTION = {  # of effects with states, which a recording has only at its samples [N]
    'viscoelastic_relaxation': 0.03, 'bouc_wen_hysteresis': 0.1, 'plastic_set': 1e-3,
    'unloading_hysteresis': 1e-3, 'viscous_flow': 1e-3, 'impact_damping': 0.1,
    'presliding_friction': 0.1, 'fractional_relaxation': 0.03, 'actuator_lag': 0.02,
    'environment_resonance': 0.03,
}


@pytest.mark.parametrize('name', SENSOR)
def test_sensor_on_arrays_is_the_contract_s_formula(name: str) -> None:
    t, x, v, a = motion(2e-5)
    force = -K_e * x
    expected = SENSED[name](t, force, a, *example_values(name))
    np.testing.assert_allclose(example(name).sense_along(t, force, a), expected, atol=0.1)


@pytest.mark.parametrize('name', SENSOR)
def test_sensor_on_samples_is_that_of_small_steps(name: str) -> None:
    t, x, _, a = motion(2e-3)
    effect, fine = example(name), motion(1e-4)
    steps = [effect.sense(now, 1e-4 if now else 0.0, -K_e * place, turn)
             for now, place, _, turn in zip(*(column.tolist() for column in fine))]
    got = effect.sense_along(t, -K_e * x, a)
    np.testing.assert_allclose(got, steps[::20][:len(t)], atol=0.01)


@pytest.mark.parametrize('name', SENSOR)
def test_reading_of_the_plant_is_that_of_the_sensor_on_arrays(name: str) -> None:
    effect = example(name)
    assert isinstance(effect, ForceSensorEffect)
    t, _, _, a, force, sensed = truths_of(name, 3500, sample_rate=5000.0)
    np.testing.assert_allclose(sensed, effect.sense_along(t, force, a), atol=1e-7)


@pytest.mark.parametrize('name', ROBOT)
def test_robot_on_arrays_moves_as_the_plant(name: str) -> None:
    t, x, v, a, force, _ = truths_of(name)
    robot = RobotLaw(M_t, B_t, K_t, [example(name)])
    reference = np.array([reference_at(now - robot.reference_delay) for now in t]).T
    driving = robot.force_along(t, x, v, reference)
    np.testing.assert_allclose(
        robot.mass * a, driving + force, atol=PREDICTION.get(name, 1e-9))


# Where the tool turns, a play switches without end; test_attached_walls.py has one that is moved.
@pytest.mark.parametrize('name', [
    n for n in WALL if not EFFECTS[n].needs_touch and n != 'backlash'])  # type: ignore
def test_attached_wall_obeys_the_law_at_all_times(name: str) -> None:
    t, x, v, a, force, _ = truths_of(name, environment__unilateral=False)
    got = law_of(name, unilateral=False).force(t, x, v, a)
    assert np.max(force) > 1.0  # it pulls
    np.testing.assert_allclose(got, force, atol=PREDICTION.get(name, 1e-9))


def test_dent_stays_where_the_tool_was_deepest() -> None:
    depths = np.array([0.0, 0.004, 0.010, 0.006, 0.002, 0.006])
    still = np.zeros(6)
    force = law_of('plastic_set').force(instants(6), depths, still, still)
    np.testing.assert_allclose(force, -K_e * np.array([0, 0.0028, 0.007, 0.003, 0, 0.003]))


def test_plant_and_prediction_agree_on_the_dent() -> None:
    *_, force, _ = truths_of('plastic_set')
    # The second touch meets the surface that the first has left.
    assert np.sum(force[350:] < 0.0) < np.sum(force[:350] < 0.0)


def test_play_is_crossed_before_the_wall_feels_the_return() -> None:
    x = np.array([0.0, 0.0002, 0.0005, 0.0045, 0.0042, 0.0036, 0.0035, 0.0025])
    still = np.zeros(8)
    force = law_of('backlash').force(instants(8), x, still, still)
    # y follows half a gap behind, stands on the return, and is half a gap ahead then.
    np.testing.assert_allclose(force, -K_e * np.array([0, 0, 0, 0.004, 0, 0, 0.004, 0.003]))


def test_wall_that_sticks_pulls_until_the_neck_tears() -> None:
    x = np.array([0.001, 1e-9, -0.0005, -0.001, -0.0016, -0.001])
    v = np.array([-1.0, -1.0, -1.0, -1.0, -1.0, -1.0])
    force = law_of('adhesion').force(instants(6), x, v, np.zeros(6))
    np.testing.assert_allclose(force, [4.0, 4.0, 4.0 * 2 / 3, 4.0 / 3, 0.0, 0.0], atol=1e-4)


def test_wall_does_not_reach_for_an_approaching_tool() -> None:
    x = np.array([0.001, -0.001, -0.001])
    force = law_of('adhesion').force(
        instants(3), x, np.array([-1.0, -1.0, 0.1]), np.zeros(3))
    assert force[1] > 0.0 == force[2]


@pytest.mark.parametrize('count', [1, 2, 3, 7, 1000])
def test_play_of_all_steps_at_once_is_that_of_one_after_the_other(count: int) -> None:
    steps, place, places = np.random.default_rng(count).normal(0.0, 0.3, count), 0.0, []
    for step in steps:
        place = min(1.0, max(-1.0, place + step))
        places.append(place)
    np.testing.assert_allclose(played(steps, 1.0), places, atol=1e-12)


@pytest.mark.parametrize('name', STATEFUL)
def test_states_that_are_kept_are_those_of_a_law_computed_anew(name: str) -> None:
    t, x, v, a = motion(2e-3)
    for signal in (x, v):
        signal.flags.writeable = False
    values = example_values(name)
    for changed in (values, *(tuple(1.1 * p if k == n else p for n, p in enumerate(values))
                              for k in range(len(values)))):
        law = ContactLaw(K_e, B_e, 0.0, 0.0, True, [example(name, changed)])
        expected = law.force(t, x.copy(), v.copy(), a)
        for _ in range(2):
            np.testing.assert_array_equal(law.force(t, x, v, a), expected)


def test_an_attracting_wall_pulls_while_it_is_pressed_too() -> None:
    x = np.array([0.001, 1e-9, -0.0015, -0.003])
    v = np.array([0.0, -1e-9, -1.0, -1.0])
    force = law_of('dmt_adhesion').force(instants(4), x, v, np.zeros(4))
    np.testing.assert_allclose(force, [5.0 - K_e * 0.001, 5.0, 2.5, 0.0], atol=1e-4)


def test_dead_zone_damps_before_its_spring_begins() -> None:
    force = law_of('dead_zone').force(
        np.array([0.0, 0.002]), np.array([0.001, 0.003]), np.array([0.1, 0.1]), np.zeros(2))
    np.testing.assert_allclose(force, [-B_e * 0.1, -(K_e * 0.001 + B_e * 0.1)])
