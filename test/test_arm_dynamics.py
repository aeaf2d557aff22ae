# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The dynamics of arms, against closed forms and MuJoCo."""

from dataclasses import replace
from pathlib import Path

from arm_worlds import along, JOINTS, motion, pressing, URDF
from contact_estimation.diagnosis.arm.arm_recording import ArmRecording
from contact_estimation.diagnosis.arm.channels import Channels
from contact_estimation.exceptions import (MissingPackageError, ModelFileError, UnknownNameError)
from contact_estimation.kinematics.arm_dynamics import ArmDynamics, Outside, PER_LINK
from contact_estimation.kinematics.robot_model import RobotModel
from contact_estimation.physics.joint_drive import through_gap
from contact_estimation.physics.joint_effects import JOINT_EFFECTS, JointMotion
from contact_estimation.plant.arm_models import arm_description, ARM_MODELS, TIP
from contact_estimation.plant.arm_simulation import ArmLaw, ArmSensors, simulate_arm
from contact_estimation.recordings.decoding import decode_arm
from contact_estimation.recordings.encoding import encode_arm
from contact_estimation.reference.arm_excitation import exciting_trajectory
from contact_estimation.studies.arm_models import (
    ARMS, description_of, mujoco, mujoco_arm, mujoco_model, TIP as TOOL_TIP, TOOL_CENTRE,
    TOOL_MASS)
from contact_estimation.studies.arm_simulation import ENGINE
from contact_estimation.studies.arm_study import StudiedArm
import numpy as np
import pytest

PLACES = {'joint': 1, 'link': 1, 'pair': (0, 1, 1), 'arm': None}


@pytest.mark.parametrize('name', ARM_MODELS)
def test_torques_are_linear_in_the_parameters_of_the_links(name: str) -> None:
    arm, rng = ArmDynamics(arm_description(name)), np.random.default_rng(0)
    q, v, a = rng.normal(size=(3, 4, len(arm.joints)))
    assert arm.regressor(q, v, a) @ arm.neutral == pytest.approx(arm.torque(q, v, a))
    other = arm.neutral * np.repeat(1.0 + 0.1 * rng.normal(size=len(arm.joints)), PER_LINK)
    assert arm.with_parameters(other).torque(q, v, a) == pytest.approx(
        arm.regressor(q, v, a) @ other)


def test_the_apparent_mass_is_that_which_a_force_accelerates() -> None:
    arm, q = ArmDynamics(arm_description('elbow_6r')), np.linspace(0.2, 0.9, 6)
    n, zero = np.array([0.6, 0.0, -0.8]), np.zeros(6)
    R, p = arm.pose(q, TIP)
    push = Outside(TIP, np.concatenate([R.T @ n, np.zeros(3)])[None])
    M, _ = arm.forward(q, zero, zero)
    acceleration = np.linalg.solve(M, arm.torque_from(q[None], push)[0])
    small = 1e-6
    moved = (arm.pose(q + small * acceleration, TIP)[1] - p) @ n / small
    assert arm.apparent_mass(q[None], TIP, n)[0] == pytest.approx(1.0 / moved, rel=1e-3)


def test_tilt_is_the_change_of_gravity_when_the_base_turns() -> None:
    arm, q = ArmDynamics(arm_description('elbow_6r')), np.full((1, 6), 0.3)
    column, small = arm.tilt(q)[0, :, 0], 1e-6
    turned = ArmDynamics(arm_description('elbow_6r').replace(
        '<link name="base"/>', '<link name="world"/><link name="base"/><joint name="mount" '
        f'type="fixed"><parent link="world"/><child link="base"/><origin rpy="0 {small} 0"/>'
        '</joint>'))
    still = np.zeros((1, 6))
    change = turned.torque(q, still, still) - arm.torque(q, still, still)
    assert change[0] / small == pytest.approx(column, rel=1e-4, abs=1e-3)


def test_placeholder_masses_are_told() -> None:
    light = ArmDynamics(URDF).with_parameters(0.003 * ArmDynamics(URDF).neutral)
    assert 'kg' in light.placeholder
    assert not ArmDynamics(URDF).placeholder


def test_an_unknown_joint_is_an_error_that_lists_the_known() -> None:
    with pytest.raises(UnknownNameError, match='joint_1, joint_2, joint_3'):
        ArmDynamics(URDF, ['joint_7'])


def test_a_joint_may_have_the_name_of_its_link() -> None:
    urdf = URDF.replace('"joint_3"', '"link_3"')
    one, other = ArmDynamics(urdf, ['joint_1', 'joint_2']), ArmDynamics(
        URDF, ['joint_1', 'joint_2'])
    q = np.array([[0.3, -0.2]])
    assert one.jacobian(q, 'link_3') == pytest.approx(other.jacobian(q, 'link_3'))
    assert RobotModel(urdf, 'base', 'link_2').joint_names == ('joint_1', 'joint_2')
    assert ArmDynamics(urdf).joints[-1] == 'link_3'


def test_a_description_without_joints_is_an_error() -> None:
    with pytest.raises(ModelFileError, match='must have joints that move, got none'):
        ArmDynamics('<robot name="box"><link name="base"/></robot>')


@pytest.mark.parametrize('name', [
    name for name, effect in JOINT_EFFECTS.items() if not effect.needs_wrench])
def test_each_law_has_a_finite_column_for_each_coefficient(name: str) -> None:
    effect, here = JOINT_EFFECTS[name], along(ArmDynamics(URDF), motion())
    place = PLACES[effect.place]
    for shape in effect.shapes(here, place):
        columns = effect.columns(here, place, shape)
        assert {one.shape for one in columns.values()} == {(len(here.q), len(effect.coefficients))}
        assert np.isfinite(list(columns.values())).all()
        assert np.abs(list(columns.values())).max() > 0.0


def test_stribeck_friction_at_an_instant_is_that_of_the_library() -> None:
    here = replace(along(ArmDynamics(URDF), motion()), period=0.0)
    v, v_s = here.v[:, 0], 0.3
    columns = JOINT_EFFECTS['stribeck_friction'].columns(here, 0, v_s)[0]
    expected = (2.0 + 3.0 * np.exp(-(v / v_s) ** 2)) * np.tanh(v / (0.02 * here.speed[0]))
    assert columns @ [2.0, 5.0] == pytest.approx(expected)


@pytest.mark.parametrize('touches', [False, True])
def test_the_link_behind_a_flexible_joint_lags_by_compliance_times_torque(touches: bool) -> None:
    arm, outside = ArmDynamics(URDF), Outside(TIP, pressing()) if touches else None
    here = replace(along(arm, motion()), outside=outside)
    column = JOINT_EFFECTS['joint_flexibility'].columns(here, 0, 0.0)[1][:, 0]
    lag = 1e-6 * here.load[:, 0]
    q, v, a = here.q.copy(), here.v.copy(), here.a.copy()
    for signal in (q, v, a):
        signal[:, 0] -= lag
        lag = np.gradient(lag, here.period)
    change = arm.torque(q, v, a) - arm.torque_from(q, outside) - (here.load - here.felt)
    assert column == pytest.approx(
        change[:, 1] / 1e-6, rel=0.01, abs=0.01 * np.abs(change[:, 1]).max() / 1e-6)


def test_a_link_crosses_its_gap_as_a_free_body_after_the_load_changes_its_side() -> None:
    arm, h, gap = ArmDynamics(URDF), 1e-3, 0.02
    t = np.arange(0.0, 2.0, h)
    load, still = np.zeros((len(t), 3)), np.zeros((len(t), 3))
    load[:, 0] = 40.0 * (1.0 - t)
    here = JointMotion(arm, still, still, still, load, np.ones(3), np.zeros(3), load, h)
    lag = through_gap(here, 0, gap)
    inertia = here.slopes[2][0, 0, 0]
    crossed = (6.0 * inertia * gap / 40.0) ** (1.0 / 3.0)  # I y = -40 (t - 1)^3 / 6
    assert lag[t < 1.0] == pytest.approx(0.5 * gap)
    assert lag[t > 1.01 + crossed] == pytest.approx(-0.5 * gap)
    assert lag[t < 0.99 + crossed][-1] > -0.5 * gap
    assert JOINT_EFFECTS['backlash'].shapes(here, 1) == ()


def test_an_exciting_motion_stays_within_limits_and_is_better_than_a_draw() -> None:
    arm = ArmDynamics(arm_description('elbow_6r'))
    best, first = (exciting_trajectory(arm, 3, 10.0, tries=tries) for tries in (8, 1))
    low, high = arm.limits['position']
    assert (best.q > low).all() and (best.q < high).all()
    assert (np.abs(best.v) <= arm.limits['velocity']).all()
    assert (np.abs(arm.torque(best.q, best.v, best.a)) <= arm.limits['effort']).all()
    assert best.condition < first.condition
    assert best.as_csv(arm).startswith('t,position.joint_1,')


def test_a_joint_state_of_an_arm_is_decoded_as_it_was_encoded() -> None:
    q, tau = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])
    reading = decode_arm(encode_arm(5_000_000_007, JOINTS, q, np.zeros(0), tau))
    assert reading.stamp_ns == 5_000_000_007 and reading.names == JOINTS
    assert reading.position.tolist() == q.tolist() and not len(reading.velocity)
    assert reading.effort.tolist() == tau.tolist()


def test_a_simulated_arm_obeys_its_laws_and_sticks() -> None:
    arm, wanted = ArmDynamics(URDF), motion(1, 6.0)
    laws = [ArmLaw('coulomb_friction', [2.0], j, 1e-3) for j in range(3)]
    laws += [ArmLaw('force_gain', [0.5], 2)]
    states = simulate_arm(arm, wanted, laws, ArmSensors(1000.0))
    a = np.gradient(states.v, states.t, axis=0)
    load = arm.torque(states.q, states.v, a)
    moving = np.abs(states.v).min(axis=1) > 0.05
    assert states.tau[moving, 0] == pytest.approx(
        (load + 2.0 * np.sign(states.v))[moving, 0], abs=0.5)
    assert states.tau[moving, 2] == pytest.approx(
        1.5 * (load + 2.0 * np.sign(states.v))[moving, 2], abs=0.5)


pytest.importorskip('pinocchio')


@pytest.fixture(params=ARMS, name='urdf')
def _urdf(request: pytest.FixtureRequest) -> tuple[str, str]:
    """Return base and description of an arm; skip where the extra is not installed."""
    arm = ARMS[request.param]
    try:
        mujoco()
        return arm.base, description_of(arm)
    except MissingPackageError as error:
        pytest.skip(str(error))


def test_pose_and_jacobian_equal_those_of_mujoco(urdf: tuple[str, str]) -> None:
    base, text = urdf
    ours, theirs = RobotModel(text, base, TOOL_TIP), mujoco_model(text, 1e-3)
    data, rng = mujoco().MjData(theirs), np.random.default_rng(5)
    for _ in range(20):
        q, q_dot = rng.uniform(-2.5, 2.5, theirs.nq), rng.normal(size=theirs.nv)
        data.qpos[:] = q
        mujoco().mj_forward(theirs, data)
        J, site = np.zeros((6, theirs.nv)), data.site(TOOL_TIP)
        mujoco().mj_jacSite(theirs, data, J[:3], J[3:], theirs.site(TOOL_TIP).id)
        R, p = ours.pose(q)
        np.testing.assert_allclose(R, site.xmat.reshape(3, 3), atol=1e-9)
        np.testing.assert_allclose(p, site.xpos, atol=1e-9)
        np.testing.assert_allclose(ours.jacobian(q), J, atol=1e-9)
        p_dot, omega = ours.velocity(q, q_dot)[2:]
        np.testing.assert_allclose(np.concatenate([p_dot, omega]), J @ q_dot, atol=1e-9)


@pytest.mark.parametrize('name', ENGINE.arms)
def test_torques_of_links_equal_those_of_mujoco(name: str) -> None:
    try:
        urdf = ENGINE.arms[name]()
        arm, rng = ArmDynamics(urdf), np.random.default_rng(0)
        model = mujoco_arm(urdf, arm, 1e-3)
    except MissingPackageError as error:
        pytest.skip(str(error))
    data, dofs = mujoco().MjData(model), [model.joint(one).dofadr[0] for one in arm.joints]
    q, v, a = rng.normal(size=(3, len(dofs)))
    data.qpos[dofs], data.qvel[dofs], data.qacc[dofs] = q, v, a
    mujoco().mj_inverse(model, data)
    torque = arm.torque(q[None], v[None], a[None])[0]
    np.testing.assert_allclose(data.qfrc_inverse[dofs], torque, atol=0.01)


@pytest.mark.slow
def test_tool_and_wall_of_a_simulated_arm_are_found(tmp_path: Path) -> None:
    try:
        mujoco()
        arm = StudiedArm(ARMS['ur5'], tmp_path)
    except MissingPackageError as error:
        pytest.skip(str(error))
    tool = arm.calibrated(0)
    assert tool['mass_kg']['value'] == pytest.approx(TOOL_MASS, abs=0.02)
    np.testing.assert_allclose(tool['centre_m']['value'], TOOL_CENTRE, atol=0.002)
    run, world, recording = arm.touched(0)
    found = arm.estimated(run, recording)
    assert found['stiffness'] == pytest.approx(world.K_e, rel=0.02)
    assert found['damping'] == pytest.approx(world.B_e, rel=0.1)


def test_accelerations_are_exact_within_the_band_that_is_compared() -> None:
    arm, t = ArmDynamics(URDF), np.arange(0.0, 10.0, 0.01)
    rates, sizes = 2.0 * np.pi * np.array([[0.3, 9.0], [0.4, 8.0], [0.5, 7.0]]), [0.4, 0.008]
    waves = rates[:, :, None] * t
    q, v, a = (np.einsum('jkn,jk->nj', wave, sizes * rates**order) for order, wave in enumerate(
        (np.sin(waves), np.cos(waves), -np.sin(waves))))
    tau = arm.torque(q, v, a)
    piece, = Channels([ArmRecording('run.mcap', arm.joints, t, q, v, tau)], arm).pieces
    assert (np.abs(piece.residual).max(axis=0) < 2e-3 * np.ptp(tau, axis=0)).all()
