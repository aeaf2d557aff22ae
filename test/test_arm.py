# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Contact of an arm: x, v and F_e along the normal, and the stiffness that follows."""

from functools import lru_cache
from math import nan
from typing import Any, Mapping

from arm_contact import (
    B_E, CENTRE, instants, K_E, LOCATION, MASS, messages, NORMAL, PARAMETERS, pose, START, urdf)
from contact_estimation.exceptions import ContactEstimationError
from contact_estimation.parameters import build
from contact_estimation.pipeline.axes import Result
from contact_estimation.pipeline.inputs import MessageInputs
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
import numpy as np
import pytest
from reference_messages import joint_state_bytes, wrench_bytes

pytest.importorskip('pinocchio')


def run(
    every: int = 1, split: bool = False, estimation: Mapping[str, Any] | None = None
) -> tuple[ContactSession, list[Result]]:
    """Process the messages of the arm; equal requests of the usual parameters share one run."""
    return run_once(every, split) if estimation is None else process(every, split, estimation)


@lru_cache(maxsize=None)
def run_once(every: int, split: bool) -> tuple[ContactSession, list[Result]]:
    return process(every, split, {})


def process(
    every: int, split: bool, estimation: Mapping[str, Any]
) -> tuple[ContactSession, list[Result]]:
    session, inputs = described(**estimation)
    results = []
    for topic, _, raw in messages(every, split):
        take = inputs.process_wrench if topic == '/wrench' else inputs.process_motion
        results += take(raw)
    return session, results


def test_motion_and_force_are_those_along_the_normal() -> None:
    _, results = run()
    truth = [instant.contact for instant in instants()]
    assert len(results) == len(truth)
    found = np.array([result.sample[1:] for result in results])
    expected = np.array([[s.position + LOCATION, s.velocity, s.force] for s in truth])
    np.testing.assert_allclose(found, expected, atol=1e-9)


@pytest.mark.parametrize('every, split', [(1, False), (4, False), (4, True)])
def test_stiffness_and_damping_are_found_at_any_rate_of_the_joints(
    every: int, split: bool
) -> None:
    session, results = run(every, split)
    estimate = [r.estimate for r in results][-1]
    assert estimate.stiffness == pytest.approx(K_E, rel=0.01)
    # Joints that come apart and are interpolated put x off by up to 0.08 mm.
    assert abs(estimate.damping - B_E) < max(0.05 * B_E, 2.0 * estimate.damping_std)
    assert estimate.damping_std < 0.12 * B_E
    assert not session.rejected


def test_the_compensated_wrench_is_that_of_the_contact_alone() -> None:
    _, results = run()
    free = results[10].arm
    assert free is not None and free.wrench[:3] == pytest.approx(np.zeros(3), abs=2.0)
    np.testing.assert_allclose(free.wrench[3:], 0.0, atol=1e-9)
    np.testing.assert_allclose(np.c_[free.R, free.p], pose(START)[:3], atol=1e-9)


def test_without_compensation_the_weight_is_taken_for_contact() -> None:
    _, results = run(estimation={'tool.mass': 0.0})
    error = results[10].sample.force - instants()[10].contact.force
    assert abs(error) == pytest.approx(MASS * 9.80665 * 0.8, rel=0.3)


@pytest.mark.parametrize('parameters', [{'force_sensor.axes': 'base'}, {'force_sign': -1}])
def test_axes_and_sign_of_a_wrench_are_corrected_before_the_tool(
    parameters: dict[str, Any]
) -> None:
    session, _ = described(**parameters)
    assert session.arm is not None
    session.arm.use_sensor('sensor')
    first = instants()[0]
    R = pose(list(first.q), 'sensor')[:3, :3] if 'force_sign' not in parameters else -np.eye(3)
    session.add_motion(0, *first.q, *first.q_dot)
    (result,) = session.add_wrench(0, *(R @ first.wrench[:3]), *(R @ first.wrench[3:]))
    assert result.sample.force == pytest.approx(first.contact.force, abs=1e-9)


def described(**parameters: Any) -> tuple[ContactSession, MessageInputs]:
    """Return a session that knows the arm, with parameters besides the usual ones."""
    session = ContactSession(build(EstimationParameters, {**PARAMETERS, **parameters}))
    session.describe(urdf())
    return session, MessageInputs(session)


@pytest.mark.parametrize('frame, hint', [
    ('left_tool0_controller', 'set force_sensor.frame to tool0'),
    ('panda_K', 'stiffness frame of Franka drivers'),
    ('', 'UR drivers tool0, with force_sensor.axes: base'),
    ('senser', "'senser'; did you mean 'sensor'")])
def test_a_wrench_in_an_unknown_frame_is_refused_with_a_hint(frame: str, hint: str) -> None:
    session, inputs = described()
    inputs.process_wrench(wrench_bytes([0.0] * 3, frame_id=frame))
    assert hint in session.rejection_texts['wrench_frame_unknown']
    assert session.rejected == {'wrench_frame_unknown': 1}


def test_a_normal_of_the_tip_is_held_in_contact() -> None:
    in_tip = pose(START)[:3, :3].T @ NORMAL
    _, results = run(estimation={'contact.normal': in_tip.tolist(), 'contact.normal_frame': 'tip'})
    arms = [r.arm for r in results if r.arm is not None]
    # The last sample before contact is detected decides; the arm turns a little on its way.
    normals = np.array([arm.normal for arm in arms])
    touched = next(k for k, r in enumerate(results) if r.estimate.status.value != 'free')
    assert np.ptp(normals[:touched], axis=0).max() > 1e-3
    assert np.ptp(normals[touched + 1:], axis=0).max() == 0.0


def test_the_point_that_touches_may_be_off_the_tip() -> None:
    point = np.array([0.02, -0.01, 0.05])
    _, results = run(estimation={'contact.point': point.tolist()})
    for instant, result in list(zip(instants(), results))[::200]:
        T = pose(tuple(instant.q))
        assert result.sample.position == pytest.approx(
            NORMAL @ (T[:3, :3] @ point + T[:3, 3]), abs=1e-9)


def test_a_sensor_that_the_description_lacks_is_turned_by_its_mounting() -> None:
    # The link `tool` is turned by 0.4 about z from the sensor.
    turned = {'force_sensor.frame': 'tool', 'force_sensor.rpy': [0.0, 0.0, -0.4]}
    _, results = run(estimation=turned)
    assert results[-1].sample.force == pytest.approx(instants()[-1].contact.force, abs=1e-9)


def test_the_surface_may_be_taken_at_the_first_touch() -> None:
    _, results = run(estimation={'environment.location': nan})
    assert results[-1].estimate.location == pytest.approx(LOCATION, abs=5e-4)
    assert results[-1].estimate.stiffness == pytest.approx(K_E, rel=0.03)


def test_the_tool_may_change_while_running() -> None:
    session, results = run(estimation={'tool.mass': 0.0})
    session.change_parameters({'tool.mass': MASS})
    last = instants()[-1]
    stamp_ns = results[-1].sample.stamp_ns + 2_000_000
    session.add_motion(stamp_ns, *last.q, *last.q_dot)
    (result,) = session.add_wrench(stamp_ns, *last.wrench)
    assert result.sample.force == pytest.approx(last.contact.force, abs=1e-9)


def test_velocity_that_is_not_reported_is_not_measured() -> None:
    session, _ = run()
    assert session.arm is not None
    *_, v = session.arm.motion([*START, 0.1, np.nan, 0.1])
    assert np.isnan(v)


def test_joints_that_never_come_are_named() -> None:
    session, inputs = described()
    for number in range(20):
        inputs.process_motion(joint_state_bytes(['elbow'], [0.0], stamp_ns=number))
    assert 'no joint state has shoulder, wrist' in session.rejection_texts['joint_lacking']


def test_other_joints_on_the_topic_are_of_no_concern() -> None:
    session, inputs = described()
    inputs.process_motion(messages()[0][2])
    inputs.process_motion(joint_state_bytes(['finger_joint'], [0.0], stamp_ns=10**12))
    assert 'joint_states_joint_unknown' not in session.rejected


def test_components_of_the_force_are_those_of_the_wall() -> None:
    session, _ = run()
    assert session.arm is not None
    force = np.array(session.arm.components(2))
    assert force[2] == pytest.approx(instants()[-1].contact.force, abs=1e-9)
    assert np.linalg.norm(force[:2]) == pytest.approx(3.0, abs=1e-9)  # the drag


def test_messages_before_the_description_are_counted() -> None:
    session = ContactSession(build(EstimationParameters, PARAMETERS))
    inputs = MessageInputs(session)
    for topic, _, raw in messages()[:4]:
        (inputs.process_wrench if topic == '/wrench' else inputs.process_motion)(raw)
    assert session.rejected == {'robot_description_missing': 4}


@pytest.mark.parametrize('changes, text', [
    ({'kinematics.base': ''}, 'kinematics.base must name a link'),
    ({'contact.normal': [0, 0, 0]}, 'contact.normal must be a direction'),
    ({'joint': 'elbow'}, 'must be empty for an arm'),
    ({'further_axes.y.joint': 'a', 'joint': 'b'}, 'must be empty for an arm'),
    ({'further_axes.y.joint': 'a'}, "is estimated; got further_axes.y.joint 'a'"),
    ({'kinematics.tip': ''}, r'tool\.\* needs the orientation'),
    ({'force_sign': 0.5}, 'force_sign must be 1 or -1'),
    ({'robot_description_file': '/no/such.urdf'}, 'cannot be read: No such file')])
def test_parameters_that_do_not_fit_are_refused(changes: dict[str, Any], text: str) -> None:
    with pytest.raises(ContactEstimationError, match=text):
        ContactSession(build(EstimationParameters, {**PARAMETERS, **changes}))


def test_centre_of_the_tool_matters_for_torque_only() -> None:
    _, results = run(estimation={'tool.centre': (2.0 * CENTRE).tolist()})
    free = results[10].arm
    assert free is not None and np.abs(free.wrench[3:]).max() > 0.05
    assert results[10].sample.force == pytest.approx(instants()[10].contact.force, abs=1e-9)


@pytest.mark.parametrize('degrees, warned', [(0.0, False), (15.0, False), (45.0, True)])
def test_a_normal_far_off_the_force_is_named(degrees: float, warned: bool) -> None:
    tilt = np.radians(degrees)
    across = np.array([0.8, 0.0, 0.6])
    normal = np.cos(tilt) * NORMAL + np.sin(tilt) * across
    session, _ = run(estimation={'contact.normal': normal.tolist(), 'environment.location': nan})
    found = {one.warned.name: one.warned.text for one in session.checks.ordered_warnings()}
    assert ('force_direction' in found) == warned
    if warned:
        assert 'degrees off contact.normal' in found['force_direction']
        angle = float(found['force_direction'].split('is ')[1].split()[0])
        assert angle == pytest.approx(45.0, abs=10.0)  # friction along the wall tilts it too
