# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Effects: their laws against formulas, and their contract."""

import dataclasses
from functools import lru_cache
import math
from math import isnan
from typing import Any, Callable

from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.parameters import optional_parameter, specifications
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.contact_effect import ContactEffect
from contact_estimation.physics.contact_law import ContactLaw
from contact_estimation.physics.effect import Need
from contact_estimation.physics.force_sensor_effect import ForceSensorEffect
from contact_estimation.physics.robot_effect import RobotEffect
from contact_estimation.physics.robot_friction import RobotFriction
from contact_estimation.physics.robot_law import RobotLaw
from contact_estimation.plant.world import Truth
from effect_examples import example, example_values
from effect_formulas import Array, FORMULAS, SENSED
import numpy as np
import pytest
from world_reference import (
    B_e, B_t, K_e, K_t, M_t, plant_with, reference_at, simulate, with_effect)

VANISHING = {  # where 0 or the neutral value is out of range, or another has to fit
    'stribeck_friction': {'physics__stribeck_friction__v_s': 1.0},
    'power_law_stiffness': {'physics__power_law_stiffness__K_n': K_e},
    'exponential_stiffness': {'physics__exponential_stiffness__depth': 1.0},
    'viscoelastic_relaxation': {'physics__viscoelastic_relaxation__tau': 1.0},
    'fractional_relaxation': {'physics__fractional_relaxation__alpha': 0.5},
    'settling_bias': {'physics__settling_bias__tau': 1.0},
    'joint_flexibility': {'physics__joint_flexibility__link_share': 0.5,
                          'physics__joint_flexibility__damping_ratio': 0.5},
    'environment_resonance': {'physics__environment_resonance__frequency': 5.0,
                              'physics__environment_resonance__damping_ratio': 0.1},
    'force_creep': {'physics__force_creep__tau': 1.0},
    'cogging': {'physics__cogging__period': 1.0},
    'force_decay': {'physics__force_decay__tau': 1.0},
    'dmt_adhesion': {'physics__dmt_adhesion__reach': 1.0},
    'force_saturation': {'physics__force_saturation__limit': 1e9},
    'actuator_saturation': {'physics__actuator_saturation__limit': 1e5},
    'torque_saturation': {'physics__torque_saturation__limit': 1e9},
}
WITHOUT_DAMPING = {name for name, cls in EFFECTS.items() if 'damper' in cls.changes}
PORTS = {'contact': ContactEffect, 'force_sensor': ForceSensorEffect, 'robot': RobotEffect}


@lru_cache(maxsize=None)
def without_effects(**wall: Any) -> list[Truth]:
    """Simulate the world without effects once."""
    return simulate(350, plant_with(**wall))


@dataclasses.dataclass(frozen=True)
class NeedsTwo(ContactEffect):
    """An effect with two parameters."""

    first: float = optional_parameter('One', 'N')
    second: float = optional_parameter('Other', 'N')


def test_name_is_the_key_and_port_that_of_the_base() -> None:
    for name, effect in EFFECTS.items():
        assert effect.name == name and issubclass(effect, PORTS[effect.port]), name


def test_parameters_are_off_by_default_and_described() -> None:
    for name, effect in EFFECTS.items():
        assert not effect().is_on(), name
        for spec in specifications(effect):
            assert isinstance(spec.default, float) and isnan(spec.default), (name, spec.name)
            assert spec.nan_is_off, (name, spec.name)
            assert spec.unit and len(spec.description) > 8, (name, spec.name)
            assert spec.name in effect.equation, (name, spec.name)


def test_effect_with_neutral_parameters_changes_nothing() -> None:
    for name in EFFECTS:
        wall: Any = {'environment__damping': 0.0} if name in WITHOUT_DAMPING else {}
        neutral: Any = {f'physics__{name}__{key}': value
                        for key, value in EFFECTS[name].neutral().items()}
        neutral.update(VANISHING.get(name, {}))
        got = np.array(simulate(350, plant_with(**wall, **neutral)))
        nominal = np.array(without_effects(**wall))
        np.testing.assert_allclose(got, nominal, rtol=1e-9, atol=1e-9, err_msg=name)


def test_law_gives_the_same_for_numbers_and_arrays() -> None:
    d, v = np.linspace(1e-4, 1e-2, 20), np.linspace(-0.1, 0.1, 20)
    for name in EFFECTS:
        effect = example(name)
        if isinstance(effect, ContactEffect) and not effect.states:
            law = law_of(name)
            arrays = law.resistance(0.0, d, v, (), np)
            numbers = [
                law.resistance(0.0, x, y, (), math) for x, y in zip(d.tolist(), v.tolist())]
            np.testing.assert_allclose(arrays, numbers, rtol=1e-12, err_msg=name)


def test_effect_with_only_some_of_its_parameters_is_refused() -> None:
    with pytest.raises(ParameterRangeError, match='needs_two needs all of first, second; missing'):
        NeedsTwo(first=1.0).is_on()


WALL = [name for name, cls in EFFECTS.items() if cls.port == 'contact']
SENSOR = [name for name, cls in EFFECTS.items() if cls.port == 'force_sensor']
ROBOT = [name for name, cls in EFFECTS.items()
         if cls.port == 'robot' and name != 'joint_flexibility']  # test_diagnosis_names.py
STATEFUL = [name for name in WALL if example(name).states]


def motion(h: float) -> tuple[Any, Any, Any, Any]:
    """Move into the wall and out of it, twice: time, position and derivatives."""
    t = h * np.arange(round(1.8 / h))
    x, v, a = (-0.012 * 9.0**n * np.cos(9.0 * t + 0.5 * n * np.pi) for n in range(3))
    return t, 0.006 + x, v, a


def law_of(name: str, unilateral: bool = True) -> ContactLaw:
    """Give the wall of the tests an effect."""
    return ContactLaw(K_e, B_e, 0.0, 0.0, unilateral, [example(name)])


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
    monkeypatch.setattr('contact_estimation.physics.backlash.TOLERANCE', 0.0)


@pytest.mark.slow
@pytest.mark.usefixtures('exact_positions')
def test_law_on_arrays_is_the_contract_s_formula() -> None:
    for name in WALL:
        t, x, v, a = motion(2e-5)
        expected = FORMULAS[name](t, x, v, a, *example_values(name))
        got = law_of(name).force(t, x, v, a)
        assert np.max(np.abs(expected)) > 20.0, name
        away = ~near_switch(expected, 2)
        assert np.mean(away) > 0.999, name
        np.testing.assert_allclose(
            got[away], expected[away], atol=0.02 if name in STATEFUL else 1e-9,
            err_msg=name)


@pytest.mark.slow
@pytest.mark.usefixtures('exact_positions')
def test_force_predicted_from_true_motion_is_the_true_force() -> None:
    for name in WALL:
        t, x, v, a, force, _ = truths_of(name)
        got = law_of(name).force(t, x, v, a)
        away = ~near_switch(force, 1)
        if name == 'backlash':  # where the tool turns, its law switches without end
            away &= np.abs(v) > 1e-3
        assert np.max(-force) > 10.0 and np.mean(away) > 0.9, name
        np.testing.assert_allclose(
            got[away], force[away], atol=PREDICTION.get(name, 1e-9), err_msg=name)


@dataclasses.dataclass
class Recorded:
    """What an effect asks of a recording."""

    force: float = 100.0
    depth: float = 0.03
    stroke: float = 0.03
    stiffness: float = 1e4
    duration: float = 1.0
    sample_period: float = 0.002
    touch: float = 1.0

    def clips(self, limit: float) -> bool:
        """Return False."""
        return False


@pytest.mark.parametrize('name, values, credible', [
    ('cubic_stiffness', (-3e6,), True), ('cubic_stiffness', (-4e6,), False),
    ('polynomial_stiffness', (-7e5, 1.4e7), True), ('bilinear_stiffness', (-1.1e4, 0.01), False)])
def test_no_wall_resists_less_where_it_is_deepest(
    name: str, values: tuple[float, ...], credible: bool
) -> None:
    assert EFFECTS[name](*values).may_show(Recorded()) == credible


@pytest.mark.slow
@pytest.mark.parametrize('memory', ['viscoelastic_relaxation', 'fractional_relaxation'])
def test_relaxation_is_one_of_the_whole_elastic_force(memory: str) -> None:
    laws: dict[str, Callable[[Array], Array]] = {
        'power_law_stiffness': lambda d: 18000.0 * d**1.3,
        'exponential_stiffness': lambda d: (
            K_e * d + 2.0 * (np.exp(d / 0.004) - 1.0 - d / 0.004)),
    }
    t, x, v, a = motion(1e-4)
    for name, elastic in laws.items():
        straight = elastic(np.maximum(x, 0.0)) / K_e  # the depth at which K_e has that force
        rate = np.gradient(straight, t)
        force = FORMULAS[memory](t, straight, rate, a, *example_values(memory))
        expected = force + B_e * (rate - v)
        both = [example(name), example(memory)]
        got = ContactLaw(K_e, B_e, 0.0, 0.0, True, both).force(t, x, v, a)
        away = (force < 0.0) & (got < 0.0)
        assert np.mean(away) > 0.3
        np.testing.assert_allclose(got[away], expected[away], atol=0.15, err_msg=name)
        truths = simulate(700, with_effect(memory, **{
            f'physics__{name}__{key}': value for key, value in example(name).values().items()}))
        *motion_then, force, _ = np.array(truths).T
        got = ContactLaw(K_e, B_e, 0.0, 0.0, True, both).force(*motion_then)
        away = ~near_switch(force, 1)
        np.testing.assert_allclose(got[away], force[away], atol=0.05, err_msg=name)


PREDICTION = {  # of effects with states, which a recording has only at its samples [N]
    'viscoelastic_relaxation': 0.03, 'bouc_wen_hysteresis': 0.1, 'plastic_set': 1e-3,
    'unloading_hysteresis': 1e-3, 'viscous_flow': 1e-3, 'impact_damping': 0.1,
    'presliding_friction': 0.1, 'fractional_relaxation': 0.03, 'actuator_lag': 0.02,
    'environment_resonance': 0.03,
}


def test_sensor_on_arrays_is_the_contract_s_formula() -> None:
    for name in SENSOR:
        t, x, v, a = motion(2e-5)
        force = -K_e * x
        expected = SENSED[name](t, force, a, *example_values(name))
        got = example(name).sense_along(t, force, a)
        np.testing.assert_allclose(got, expected, atol=0.1, err_msg=name)


def test_reading_of_the_plant_is_that_of_the_sensor_on_arrays() -> None:
    for name in SENSOR:
        effect = example(name)
        assert isinstance(effect, ForceSensorEffect), name
        t, _, _, a, force, sensed = truths_of(name, 3500, sample_rate=5000.0)
        got = effect.sense_along(t, force, a)
        np.testing.assert_allclose(sensed, got, atol=1e-7, err_msg=name)


def test_robot_on_arrays_moves_as_the_plant() -> None:
    for name in ROBOT:
        t, x, v, a, force, _ = truths_of(name)
        robot = RobotLaw(M_t, B_t, K_t, [example(name)])
        reference = np.array([reference_at(now - robot.reference_delay) for now in t]).T
        driving = robot.force_along(t, x, v, reference, force - robot.mass * a, 0.0)
        np.testing.assert_allclose(
            robot.mass * a, driving + force, atol=PREDICTION.get(name, 1e-9), err_msg=name)


def test_friction_holds_a_robot_at_rest_by_what_it_needs_up_to_its_bound() -> None:
    robot = RobotLaw(M_t, B_t, K_t, [RobotFriction(2.0)])
    still, pushed = np.zeros(3), np.array([-1.5, 0.0, 5.0])
    drive = robot.force_along(np.arange(3.0), still, still, np.zeros((4, 3)), pushed, 1e-2)
    np.testing.assert_allclose(drive, [1.5, 0.0, -2.0], atol=1e-9)


# Where the tool turns, a play switches without end.
@pytest.mark.slow
def test_attached_wall_obeys_the_law_at_all_times() -> None:
    for name in (n for n in WALL if Need.TOUCH not in EFFECTS[n].needs and n != 'backlash'):
        t, x, v, a, force, _ = truths_of(name, environment__unilateral=False)
        got = law_of(name, unilateral=False).force(t, x, v, a)
        assert np.max(force) > 1.0, name  # it pulls
        np.testing.assert_allclose(got, force, atol=PREDICTION.get(name, 1e-9), err_msg=name)
