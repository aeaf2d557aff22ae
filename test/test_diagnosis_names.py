# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Every effect has a world in which the diagnosis names it, and nothing is named without cause."""

from functools import lru_cache
from typing import Any

from concealed_worlds import (
    ATTACHED, attached, diagnosed, FORCE_NOISE, MODEL, named, nominal, OUTSIDE_EFFECTS, physics,
    recorded, softened, with_unknown)
from contact_estimation.diagnosis.observe.model import names_of
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.diagnosis.result import Diagnosis
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.effect import Need
from contact_estimation.physics.numeric import SIGN_VELOCITY
import numpy as np
import pytest

pytestmark = pytest.mark.slow

WORLDS: dict[str, tuple[float, ...]] = {
    'coulomb_friction': (2.0,),
    'stribeck_friction': (1.5, 4.0, 0.02),
    'presliding_friction': (3.0, 8000.0),
    'environment_inertia': (1.5,),
    'environment_resonance': (0.4, 9.0, 0.05),
    'cubic_stiffness': (3e6,),
    'power_law_stiffness': (1.2, 12000.0),
    'polynomial_stiffness': (-3e5, 1.2e7),
    'exponential_stiffness': (0.6, 0.0025),
    'hunt_crossley_damping': (12000.0,),
    'power_law_damping': (1500.0, 0.5),
    'impact_damping': (2000.0,),
    'quadratic_damping': (600.0,),
    'asymmetric_damping': (30.0,),
    'viscoelastic_relaxation': (500.0, 0.15),
    'fractional_relaxation': (800.0, 0.4),
    'bouc_wen_hysteresis': (1500.0, 150.0, 40.0),
    'contact_offset': (0.0004,),
    'moving_environment': (0.0003, 1.7, 0.7),
    'beating_environment': (0.0003, 1.7, 0.7, 0.0002, 2.3, -0.5),
    'adhesion': (4.0,),
    'dmt_adhesion': (4.0, 0.002),
    'dead_zone': (0.0008,),
    'free_play': (0.0016, 0.0005, 0.4),
    'backlash': (0.0006,),
    'bilinear_stiffness': (1500.0, 0.006),
    'stiffness_drift': (0.02,),
    'plastic_set': (0.2, 0.004),
    'cogging': (3.0, 0.002, 0.7),
    'tool_weight': (-3.0,),
    'viscous_flow': (0.02,),
    'unloading_hysteresis': (0.15,),
    'tool_inertia': (1.0,),
    'force_lag': (0.006,),
    'force_creep': (0.1, 0.4),
    'force_decay': (0.1, 0.4),
    'force_delay': (0.006,),
    'force_gain': (1.15,),
    'force_nonlinearity': (0.0008, 1.0),
    'force_bias': (2.0,),
    'force_drift': (0.3,),
    'settling_bias': (20.0, 6.0, -6.0),
    'force_saturation': (70.0,),
    'robot_friction': (3.0,),
    'robot_drag': (600.0,),
    'gravity_error': (-4.0,),
    'impedance_mismatch': (0.95, 1.1, 1.05),
    'reflected_inertia': (1.5,),
    'joint_flexibility': (4e-5, 0.2, 0.1),
    'command_delay': (0.006,),
    'actuator_lag': (0.006,),
    'actuator_saturation': (90.0,),
    'torque_saturation': (150.0,),
}
"""Parameters at which an effect is felt: it leaves 1 to 5 N, or as much in the motion."""

# Its v_s feels the steps of the integration; a joint that rings, the lines between the samples of
# the reference.
FINER: dict[str, dict[str, Any]] = {'stribeck_friction': {'integration_rate': 5000.0},
                                    'joint_flexibility': {'sample_rate': 500.0}}
BOUND = 0.04
WIDE = {('bouc_wen_hysteresis', 'gamma'): 0.15, ('stribeck_friction', 'v_s'): 0.07,
        ('joint_flexibility', 'damping_ratio'): 0.15, ('adhesion', 'F_a'): 0.05,
        ('dmt_adhesion', 'reach'): 0.06, ('force_nonlinearity', 'bend'): 0.06}


@lru_cache(maxsize=None)
def of_attached(*changes: tuple[str, float]) -> Diagnosis:
    """Diagnose a permanently attached wall once."""
    return diagnosed(attached(*changes), nominal(**ATTACHED))


@lru_cache(maxsize=None)
def of_clean(seed: int) -> Diagnosis:
    """Diagnose a world without effects once."""
    return diagnosed(recorded(seed=seed))


@pytest.mark.parametrize('name', EFFECTS)
def test_effect_is_named_with_its_parameters_and_the_wall(name: str) -> None:
    wall = {'environment__unilateral': Need.ATTACHMENT not in EFFECTS[name].needs}
    world = {**physics(name, *WORLDS[name]), **wall, **FINER.get(name, {})}
    found = diagnosed(recorded(**world), nominal(**wall))
    assert (found.verdict, named(found)) == ('physics_missing', [name])
    assert found.effects[0].port == EFFECTS[name].port
    assert found.effects[0].probability > 0.8
    for key, true in zip(names_of(name), WORLDS[name]):
        bound, value = WIDE.get((name, key), BOUND), found.effects[0].parameters[key]
        assert value.value == pytest.approx(true, rel=bound), key
        assert 0.0 < value.std < bound * abs(true), key
    stiffness_is_free, damping_is_free = found.corrected.free[:2]
    if stiffness_is_free:
        true = MODEL['environment.stiffness']
        assert found.stiffness.value == pytest.approx(true, rel=0.005)
    if damping_is_free:
        assert found.damping.value == pytest.approx(MODEL['environment.damping'], rel=0.01)
    assert found.force.corrected == pytest.approx(FORCE_NOISE, rel=0.25)
    if EFFECTS[name].port != 'robot':
        assert found.force.recalibrated is not None and found.force.corrected is not None
        assert found.force.corrected < 0.6 * found.force.recalibrated


@pytest.mark.parametrize('seed', [1, 2])
def test_clean_world_is_consistent_and_has_no_names(seed: int) -> None:
    found = of_clean(seed)
    assert found.verdict == 'consistent'
    assert not found.effects
    assert found.location is None
    assert found.residual_power == pytest.approx(1.0, abs=0.2)


def test_other_values_of_the_wall_are_recalibrated() -> None:
    found = diagnosed(recorded(environment__stiffness=5600.0, environment__damping=90.0))
    assert (found.verdict, named(found)) == ('recalibrate', [])
    assert found.recalibrated.stiffness == pytest.approx(5600.0, rel=0.001)
    assert found.recalibrated.damping == pytest.approx(90.0, rel=0.01)


@pytest.mark.parametrize('missing, names', [
    ({}, []), (physics('command_delay', 0.004), ['command_delay'])])
def test_a_cable_at_the_tool_is_no_missing_physics(
    missing: dict[str, Any], names: list[str]
) -> None:
    signals = recorded(**missing)
    stroke, force = np.ptp(signals.position), np.ptp(signals.force)
    pull = 0.03 * force * (signals.position - signals.position[0]) / stroke
    assert named(diagnosed(signals._replace(force=signals.force - pull))) == names


def test_two_effects_are_named_together() -> None:
    pair = {**physics('coulomb_friction', 2.0), **physics('force_delay', 0.006)}
    found = diagnosed(recorded(**pair))
    assert sorted(named(found)) == ['coulomb_friction', 'force_delay']
    values = {effect.name: effect.parameters for effect in found.effects}
    assert values['coulomb_friction']['F_c'].value == pytest.approx(2.0, rel=BOUND)
    assert values['force_delay']['delay'].value == pytest.approx(0.006, rel=BOUND)


def test_relaxation_of_a_curved_elastic_force_is_named_with_its_law() -> None:
    true = {'exponential_stiffness': (0.6, 0.0025), 'fractional_relaxation': (800.0, 0.4)}
    found = diagnosed(recorded(**{key: value for name, values in true.items()
                                  for key, value in physics(name, *values).items()}))
    assert set(named(found)) == set(true)
    for effect in found.effects:
        values = [value.value for value in effect.parameters.values()]
        assert values == pytest.approx(true[effect.name], rel=0.04)
    assert found.force.corrected == pytest.approx(FORCE_NOISE, rel=0.2)


@pytest.mark.parametrize('stray', [0.0, 0.6])
def test_a_pull_at_each_release_is_named_beside_an_offset_of_the_surface(stray: float) -> None:
    # It lasts for a few blocks, and the offset explains nine tenths.
    s = recorded(**physics('dmt_adhesion', 4.0, 0.0008), **physics('contact_offset', 0.0006))
    away = stray * np.sin(2.1 * s.wrench_t) * np.sin(5.3 * s.wrench_t)  # no law explains it
    found = diagnosed(s._replace(force=s.force + away))
    assert [effect.family for effect in found.effects] == ['clearance', 'adhesion']


def test_a_law_is_named_and_not_one_that_has_it_as_a_special_case() -> None:
    found = diagnosed(recorded(**physics('presliding_friction', 0.6, 6000.0)))
    assert named(found) == ['presliding_friction']
    assert 'bouc_wen_hysteresis' in found.effects[0].indistinguishable_from
    assert found.effects[0].parameters['F_c'].value == pytest.approx(0.6, rel=BOUND)


@lru_cache(maxsize=None)
def in_units(name: str, length: float, force: float) -> Diagnosis:
    """Diagnose a world whose recording and nominal model are in other units."""
    s, scale = recorded(**physics(name, *WORLDS[name])), force / length
    other = s._replace(
        force=force * s.force, position=length * s.position,
        reference=np.array([length, length, length, force])[:, None] * s.reference)
    return diagnosed(other, nominal(sign_velocity=length * SIGN_VELOCITY, **{
        key.replace('.', '__'): scale * value for key, value in MODEL.items()}))


@pytest.mark.parametrize('length, force', [(1e3, 1e3), (1e6, 1e9), (1e9, 1e12)])
@pytest.mark.parametrize('name', ['coulomb_friction', 'hunt_crossley_damping'])
def test_no_decision_depends_on_units(name: str, length: float, force: float) -> None:
    usual, found = in_units(name, 1.0, 1.0), in_units(name, length, force)
    assert named(found) == named(usual) == [name]
    for one, other in zip(found.effects, usual.effects):
        assert one.probability == pytest.approx(other.probability, abs=0.005)
        assert one.indistinguishable_from == other.indistinguishable_from
        assert one.share == pytest.approx(other.share, abs=1e-4)
    unit = force if name == 'coulomb_friction' else force / length**2
    value, usual_value = (next(iter(each.effects[0].parameters.values())).value
                          for each in (found, usual))
    assert value == pytest.approx(unit * usual_value, rel=1e-4)


@pytest.mark.parametrize('length, force', [(1e6, 1e9), (1e3, 1e3)])
def test_friction_keeps_its_name_where_the_width_of_the_sign_has_another_unit(
    length: float, force: float
) -> None:
    s = recorded(**physics('coulomb_friction', 2.0))
    other = s._replace(position=length * s.position, force=force * s.force, reference=np.array(
        [length, length, length, force])[:, None] * s.reference)
    found = diagnosed(other, nominal(**{
        key.replace('.', '__'): force / length * value for key, value in MODEL.items()}))
    assert named(found) == ['coulomb_friction']
    assert found.effects[0].parameters['F_c'].value == pytest.approx(2.0 * force, rel=BOUND)


OUTSIDE = {
    'soft_spell': {'softer': 600.0, 'first': 1.3, 'last': 2.3},
    'warming_wall': {'softening': 15000.0, 'tau': 1.0},
    'ripple': {'amplitude': 3.0, 'wavelength': 0.004},
    'hum': {'amplitude': 2.0, 'frequency': 13.0},
    'dead_band': {'width': 6.0},
}


@lru_cache(maxsize=None)
def of_unknown(name: str) -> Diagnosis:
    """Diagnose a world with an effect outside the library once."""
    return diagnosed(with_unknown(name, *OUTSIDE[name].items()))


@pytest.mark.parametrize('name', OUTSIDE_EFFECTS)
def test_what_the_library_has_not_is_located_and_not_named(name: str) -> None:
    found = of_unknown(name)
    assert (found.verdict, named(found)) == ('unexplained', [])
    assert found.location is not None
    assert found.location.port == OUTSIDE_EFFECTS[name].port
    assert found.next_experiment


@pytest.mark.parametrize('spell', [(1.3, 2.3), (3.5, 4.5)], ids=['fitted', 'held out'])
def test_what_happens_for_a_while_is_found_and_when(spell: tuple[float, float]) -> None:
    signals = softened(*spell)
    found = of_unknown('soft_spell') if spell == (1.3, 2.3) else diagnosed(signals)
    assert (found.verdict, named(found)) == ('unexplained', [])
    assert found.location is not None
    assert found.location.port == 'contact'
    t, touching = signals.wrench_t, signals.position > 0.0
    true = (t > spell[0]) & (t < spell[1]) & touching
    told = np.any([(t >= a) & (t <= b) for a, b in found.location.intervals_s], axis=0)
    assert np.sum(true & told) > 0.5 * np.sum(true | told)


def test_attached_wall_of_the_right_values_is_consistent() -> None:
    found = of_attached()
    assert (found.verdict, named(found)) == ('consistent', [])


def test_attached_wall_of_other_values_is_recalibrated() -> None:
    found = of_attached(('environment__stiffness', 5500.0), ('environment__damping', 14.0),
                        ('environment__inertia', 2.2))
    assert (found.verdict, named(found)) == ('recalibrate', [])
    assert found.recalibrated.values == pytest.approx((5500.0, 14.0, 2.2), rel=0.001)


def test_cogging_is_found_beneath_friction() -> None:
    wall: dict[str, Any] = {'environment__unilateral': False}
    both = {**physics('coulomb_friction', 8.0), **physics('cogging', 3.0, 0.002, 0.7)}
    found = diagnosed(recorded(**wall, **both), nominal(**wall))
    assert sorted(named(found)) == ['cogging', 'coulomb_friction']


def test_cogging_of_many_periods_along_the_way_is_found() -> None:
    t, rng = np.arange(0.0, 12.0, 0.002), np.random.default_rng(1)
    x = 0.025 * (1.0 - np.cos(0.4 * np.pi * t))
    ripple = 1.5 * np.sin(2.0 * np.pi * x / 3e-4 + 0.7)
    force = -4800.0 * x - 200.0 * np.gradient(x, t) - ripple + rng.normal(0.0, 0.1, len(t))
    found = diagnosed(
        Signals(t, force, t, x + rng.normal(0.0, 1e-6, len(t)), np.empty(0), np.empty((4, 0))),
        nominal(environment__unilateral=False))
    assert named(found) == ['cogging']
    assert found.effects[0].parameters['period'].value == pytest.approx(3e-4, rel=1e-4)


def test_strong_cubic_spring_of_an_attached_wall_is_named() -> None:
    found = of_attached(('physics__cubic_stiffness__K_3', 1e7))
    assert (found.verdict, named(found)) == ('physics_missing', ['cubic_stiffness'])
    assert found.effects[0].parameters['K_3'].value == pytest.approx(1e7, rel=0.005)
    assert found.stiffness.value == pytest.approx(5000.0, rel=0.001)
