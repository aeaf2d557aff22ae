# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What the diagnosis of a whole arm names, on a small arm whose physics is known."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from arm_worlds import arm_recording, FRICTION, motion, pressing, URDF
from contact_estimation.diagnosis.arm.arm_recording import (
    ArmRecording, named_as, read_arm_recording)
from contact_estimation.diagnosis.arm.conclude import diagnose_arm
from contact_estimation.diagnosis.arm.contact import tip_lag
from contact_estimation.diagnosis.arm.corrected_robot import corrected_urdf, mjcf_snippet
from contact_estimation.diagnosis.arm.result import ArmDiagnosis
from contact_estimation.diagnosis.arm.text import as_dict, as_html, as_text
from contact_estimation.exceptions import ModelFileError, RecordingError
from contact_estimation.kinematics.arm_dynamics import ArmDynamics, Outside
from contact_estimation.kinematics.description import joint_friction
from contact_estimation.parameters import build
from contact_estimation.physics.joint_effects import ONE_DELAY
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.plant.arm_models import TIP
from contact_estimation.plant.arm_simulation import ArmLaw
import numpy as np
import pytest

BODY = [1.0, 0.1, 0.02, 0.05, 0.01, -0.002, 0.02, -0.005, -0.001, 0.02]
CONCEALED = {
    'reflected_inertia': ArmLaw('reflected_inertia', [2.0], 0),
    'force_bias': ArmLaw('force_bias', [9.0], 1),
    'force_gain': ArmLaw('force_gain', [0.2], 0),
    'force_delay': ArmLaw('force_delay', [0.03]),
    ONE_DELAY: ArmLaw(ONE_DELAY, [0.04], 0),
    'joint_spring': ArmLaw('joint_spring', [4.0, 0.0], 1),
    'payload': ArmLaw('payload', BODY, 2),
    'base_tilt': ArmLaw('base_tilt', [0.08, 0.0]),
    'coupled_friction': ArmLaw('coupled_friction', [3.0, 0.5, 0.0], (1, 2, 1)),
    'joint_flexibility': ArmLaw('joint_flexibility', [0.0008], 0),
    'stribeck_friction': ArmLaw('stribeck_friction', [0.0, 5.0], 1, 0.15),
    'load_dependent_friction': ArmLaw('load_dependent_friction', [0.0, 0.2], 0, 0.003),
}


@lru_cache(maxsize=None)
def diagnosed(name: str) -> ArmDiagnosis:
    """Return the diagnosis of a world with one concealed law, beside friction."""
    return diagnose_arm(arm_recording([CONCEALED[name]] if name in CONCEALED else []), URDF)


@pytest.mark.parametrize('name', CONCEALED)
def test_a_law_is_named_at_its_joint(name: str) -> None:
    law, found = CONCEALED[name], diagnosed(name)
    names = [(one.term.effect, one.term.place) for one in found.effects]
    assert (name, law.place) in names, as_text(found)
    first = found.effects[names.index((name, law.place))]
    value = next(iter(first.parameters.values()))
    wanted = law.theta[0] or value.value
    assert abs(value.value - wanted) < max(4.0 * value.std, 0.15 * abs(wanted))


def test_an_arm_with_friction_and_inexact_links_lacks_nothing_else() -> None:
    found = diagnosed('nothing')
    assert found.verdict == 'physics_missing'
    assert {one.family for one in found.effects} == {'friction'}
    values = {(one.name, one.term.place): next(iter(one.parameters.values()))
              for one in found.effects}
    for law in FRICTION[:4]:
        assert values[law.effect, law.place].value == pytest.approx(law.theta[0], rel=0.15)
    assert [one.friction for one in found.joints[:2]] == [
        pytest.approx((3.0, 2.0), rel=0.1), pytest.approx((1.5, 1.0), rel=0.1)]


def test_an_arm_that_presses_lacks_its_friction_and_nothing_else() -> None:
    found = diagnose_arm(arm_recording(pressed=pressing()), URDF)
    assert {one.family for one in found.effects} == {'friction'} and not found.contact
    assert found.joints[0].friction == pytest.approx((3.0, 2.0), rel=0.1)
    assert found.joints[0].share > 0.999 and 'Apparent mass of the tip' in as_text(found)
    concealed = ArmLaw('payload', BODY, 2)
    loaded = diagnose_arm(arm_recording([concealed], pressed=pressing()), URDF)
    assert [one.name for one in loaded.effects if one.family != 'friction'] == ['payload']


def test_a_sensor_that_feels_nothing_changes_nothing() -> None:
    found = diagnose_arm(arm_recording(pressed=0.0 * pressing()), URDF)
    assert {one.family for one in found.effects} == {'friction'} and found.apparent_mass is None
    assert found.joints[0].friction == pytest.approx(diagnosed('nothing').joints[0].friction,
                                                     rel=0.05)


def test_the_tip_lags_by_what_its_joints_yield() -> None:
    one, arm, n = arm_recording(pressed=pressing()), ArmDynamics(URDF), np.array([0.6, 0.0, -0.8])
    assert one.wrench is not None
    parameters = build(EstimationParameters, {
        'kinematics.base': 'base', 'kinematics.tip': TIP, 'contact.normal': [3.0, 0.0, -4.0]})
    states = replace(one, wrench=replace(one.wrench, parameters=parameters))
    lag = tip_lag(states, arm, {'joint_2': 1e-5})
    for k in (100, 1300, 2300):
        still = np.zeros((1, 3))
        load = (arm.torque(one.q[k:k + 1], still, still) - arm.torque_from(
            one.q[k:k + 1], Outside(TIP, one.wrench.measured[k:k + 1])))[0, 1]
        behind = one.q[k] - [0.0, 1e-5 * load, 0.0]
        moved = arm.pose(one.q[k], TIP)[1] - arm.pose(behind, TIP)[1]
        assert lag[k] == pytest.approx(float(n @ moved), rel=1e-3)


def test_laws_that_lack_together_are_named_together() -> None:
    concealed = [ArmLaw('joint_spring', [30.0, 0.0], 1), ArmLaw('reflected_inertia', [1.5], 1)]
    found = diagnose_arm(arm_recording(concealed), URDF)
    beyond = {(one.name, one.term.place) for one in found.effects if one.family != 'friction'}
    assert beyond == {('joint_spring', 1), ('reflected_inertia', 1)}


def test_a_wrench_of_an_unknown_link_is_told_and_not_used() -> None:
    one = arm_recording(pressed=pressing())
    assert one.wrench is not None
    found = diagnose_arm(replace(one, wrench=replace(one.wrench, frame='elsewhere')), URDF)
    assert [check.name for check in found.checks if not check.ok] == ['wrench_frame']
    assert 'force_sensor.frame' in as_text(found) and found.apparent_mass is None


def test_a_zero_of_the_wrench_is_named_as_such() -> None:
    one = arm_recording(pressed=pressing())
    assert one.wrench is not None
    off = replace(one.wrench, measured=one.wrench.measured + [0.0, 0.0, 25.0, 0.0, 0.0, 0.0])
    found = diagnose_arm(replace(one, wrench=off), URDF)
    assert [one.name for one in found.effects if one.family != 'friction'] == ['wrench_bias']


def test_a_torque_that_is_no_function_of_the_state_is_unexplained_at_its_joint() -> None:
    t = motion().t
    wave = 6.0 * np.sum([np.sin(2.0 * np.pi * f * t + f) for f in (0.21, 0.37, 0.53, 0.83)], 0)

    def disturbed(tau: Any) -> Any:
        return tau + wave[:, None] * [0.0, 1.0, 0.0]

    found = diagnose_arm(arm_recording(tau=disturbed), URDF)
    assert {one.name: one.verdict for one in found.joints}['joint_2'] == 'unexplained'
    assert found.verdict == 'unexplained' and 'joint_2' in as_text(found)


@pytest.mark.parametrize('check, changes', [
    ('torque_sign', {'tau': lambda tau: -tau}),
    ('torque_sign', {'tau': lambda tau: tau * [1.0, -1.0, 1.0]}),
    ('joint_order', {'tau': lambda tau: tau[:, [1, 0, 2]]}),
    ('joint_order', {'tau': lambda tau: tau[:, [1, 0, 2]], 'q': lambda q: q[:, [1, 0, 2]]}),
    ('angle_unit', {'q': np.degrees}),
    ('torque_unit', {'tau': lambda tau: 1000.0 * tau}),
    ('torque_unit', {'tau': lambda tau: tau / 100.0}),
    ('torque_unit', {'tau': lambda tau: tau * [1.0, 1.0, 3.0]}),
    ('position_sign', {'q': lambda q: q * [1.0, -1.0, 1.0]}),
    ('position_sign', {'q': lambda q: q * [1.0, -1.0, 1.0],
                       'tau': lambda tau: tau * [1.0, -1.0, 1.0]}),
    ('torque_gravity', {'tau': lambda tau: tau - weight()}),
    ('base_mounting', {'tau': lambda tau: tau - 2.0 * weight()}),
    ('base_mounting', {'tau': lambda tau: tau - weight() + ArmDynamics(URDF).tilt(
        motion().q)[..., 0]}),
    ('torque_external', {'tau': lambda tau: 0.05 * np.ptp(tau, axis=0) * np.tanh(motion().v)})])
def test_wrong_use_is_told_before_any_name(check: str, changes: dict[str, Any]) -> None:
    found = diagnose_arm(arm_recording(**changes), URDF)
    assert [one.name for one in found.checks if not one.ok] == [check]
    assert found.refused and not found.effects and as_dict(found)['verdict'] == 'unexplained'


def weight() -> Any:
    """Return the torques of gravity along the motion."""
    still = np.zeros_like(motion().q)
    return ArmDynamics(URDF).torque(motion().q, still, still)


@pytest.mark.parametrize('held', [
    lambda q: 35.0 * np.sin(q - q.mean()) / (0.4 + 0.6 * np.cos(q - q.mean())),
    lambda q: 20.0 * np.cos(q) - 20.0])
def test_an_accumulator_is_named_and_no_unit_or_zero_is_blamed(held: Any) -> None:
    found = diagnose_arm(arm_recording(
        tau=lambda tau: tau + np.outer(held(motion().q[:, 1]), [0.0, 1.0, 0.0])), URDF)
    assert not found.refused
    beyond = [(one.family, one.term.place) for one in found.effects if one.family != 'friction']
    assert beyond == [('elastic_law', 1)], as_text(found)


def test_a_heavy_tool_rotors_and_a_spring_are_named_together() -> None:
    tool = [3.0, 0.6, 0.0, 0.0, 0.03, 0.0, 0.15, 0.0, 0.0, 0.15]
    rotors = [ArmLaw('reflected_inertia', [I_r], j) for j, I_r in enumerate((1.5, 1.0, 0.15))]
    laws = [ArmLaw('payload', tool, 2), ArmLaw('joint_spring', [60.0, 0.0], 1), *rotors]
    found = diagnose_arm(arm_recording(laws, seed=2), URDF)
    beyond = {(one.name, one.term.place): one for one in found.effects if one.family != 'friction'}
    assert set(beyond) == {(law.effect, law.place) for law in laws}, as_text(found)
    assert beyond['payload', 2].parameters['mass'].value == pytest.approx(3.0, rel=0.05)


def test_a_load_heavier_than_the_last_links_is_no_unit() -> None:
    tool = [8.0, 1.6, 0.0, 0.0, 0.08, 0.0, 0.4, 0.0, 0.0, 0.4]
    found = diagnose_arm(arm_recording([ArmLaw('payload', tool, 2)]), URDF)
    assert not found.refused
    assert [one.name for one in found.effects if one.family != 'friction'] == ['payload']


def test_each_recording_has_a_payload_of_its_own() -> None:
    loads = [[factor * x for x in BODY] for factor in (1.0, 2.5)]
    both = [arm_recording([ArmLaw('payload', load, 2)], seed) for seed, load in enumerate(loads)]
    found = diagnose_arm(both, URDF)
    beyond = [one for one in found.effects if one.family != 'friction']
    assert [one.name for one in beyond] == ['payload', 'payload'], as_text(found)
    for one in beyond:
        assert one.parameters['mass'].value == pytest.approx(loads[one.term.file][0], rel=0.1)


def test_rests_without_the_ways_between_them_are_refused() -> None:
    t = motion().t
    rest = (t // 4.0).astype(int)
    poses = motion().q[np.searchsorted(t, 4.0 * rest)]
    one = replace(arm_recording(q=lambda q: poses), t=t + 3.0 * rest)
    found = diagnose_arm(one, URDF)
    assert found.refused and 'move every joint' in as_text(found)


@pytest.mark.parametrize('mass', ['0.01', '1.0'])
def test_placeholder_masses_are_refused(mass: str) -> None:
    root = ElementTree.fromstring(URDF)
    for one in root.iter('mass'):
        one.set('value', mass)
    found = diagnose_arm(arm_recording(), ElementTree.tostring(root, encoding='unicode'))
    assert found.refused and 'placeholders' in as_text(found)


def test_a_joint_without_effort_is_told_and_left_out() -> None:
    found = diagnose_arm(arm_recording(tau=lambda tau: tau * [1.0, 1.0, 0.0]), URDF)
    assert [one.name for one in found.joints] == ['joint_1', 'joint_2']
    assert 'joint_3: publishes no effort' in as_text(found)


def test_an_arm_at_rest_is_refused_and_a_joint_at_rest_left_out() -> None:
    still = diagnose_arm(arm_recording(q=lambda q: 0.0 * q), URDF)
    assert still.refused and 'move every joint' in as_text(still)
    one = diagnose_arm(arm_recording(q=lambda q: q * [1.0, 1.0, 0.0]), URDF)
    assert one.left_out == {'joint_3': 'rests'} and len(one.joints) == 2


def test_a_hand_that_is_not_mounted_is_told() -> None:
    lack = ArmLaw('payload', [-x for x in BODY], 2)
    found = diagnose_arm(arm_recording([lack]), URDF)
    tool = next(one for one in found.checks if one.name == 'tool')
    assert not tool.ok and 'not mounted' in tool.text


def test_a_clock_offset_is_told() -> None:
    late = diagnose_arm(arm_recording(tau=lambda tau: np.roll(tau, 8, axis=0)), URDF)
    clock = next(one for one in late.checks if one.name == 'clock_offset')
    assert not clock.ok and '80 ms later' in clock.text


def test_other_joints_than_those_described_are_an_error() -> None:
    one = arm_recording()
    other = ArmRecording(one.name, ('a', 'b', 'c'), one.t, one.q, one.v, one.tau)
    with pytest.raises(RecordingError, match='expected those of the robot description: joint_1'):
        diagnose_arm(other, URDF)


def test_a_table_of_numbered_joints_has_the_order_of_the_arm(tmp_path: Path) -> None:
    one, path = arm_recording(), tmp_path / 'log.csv'
    names = [f'q{k},tau_{k}' for k in (2, 0, 1)]
    rows = [column for k in (2, 0, 1) for column in (one.q[:, k], one.tau[:, k])]
    np.savetxt(path, np.column_stack([one.t, *rows]), delimiter=',', comments='',
               header=f't,{",".join(names)}')
    read = named_as(read_arm_recording(path), ArmDynamics(URDF))
    assert read.joints == one.joints and read.wrench is None
    assert read.q == pytest.approx(one.q) and read.tau == pytest.approx(one.tau)
    chosen = {'joint.elbow': 'q0', 'joint.elbow.effort': 'tau_0'}
    assert read_arm_recording(path, columns=chosen).joints == ('elbow',)


def test_the_corrected_description_explains_what_the_nominal_one_does_not() -> None:
    found = diagnosed('payload')
    text = corrected_urdf(found, URDF)
    again = diagnose_arm(arm_recording([CONCEALED['payload']], friction=False), text)
    assert 'payload' not in [one.name for one in again.effects]
    assert 'friction=' in text and 'frictionloss=' in mjcf_snippet(found)


def test_friction_is_read_back_from_the_written_description(tmp_path: Path) -> None:
    found, file = diagnosed('nothing'), tmp_path / 'c.urdf'
    file.write_text(corrected_urdf(found, URDF))
    read = joint_friction(file)
    assert read == {one.name: pytest.approx(one.friction, rel=1e-5) for one in found.joints}
    file.write_text(file.read_text().replace('friction="', 'friction="much'))
    for read_wrong in (lambda: joint_friction(file), lambda: ArmDynamics(file.read_text())):
        with pytest.raises(ModelFileError, match='friction of joint_1 must be a number >= 0'):
            read_wrong()
    with pytest.raises(ModelFileError, match='cannot be read'):
        joint_friction(tmp_path / 'none.urdf')


def test_rotor_inertia_of_the_first_joint_is_also_that_of_its_link() -> None:
    first = diagnosed('reflected_inertia').effects[0]
    assert 'link_inertia at link_1' in first.indistinguishable_from


def test_the_page_shows_the_arm_and_every_name() -> None:
    found = diagnosed('payload')
    page = as_html(found, 'run')
    assert page.count('data:image/png') == 3
    assert all(one.name.replace('_', ' ') in page for one in found.effects)
