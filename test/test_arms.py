# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Arms simulated in MuJoCo, an independent form of kinematics, sensor load and contact."""

from __future__ import annotations

from pathlib import Path

from contact_estimation.exceptions import MissingPackageError
from contact_estimation.kinematics.arm_dynamics import ArmDynamics
from contact_estimation.kinematics.robot_model import RobotModel
from contact_estimation.studies.arm_concealed_laws import ENGINE, mujoco_arm
from contact_estimation.studies.arm_models import (
    ARMS, description_of, mujoco, mujoco_model, TIP, TOOL_CENTRE, TOOL_MASS)
from contact_estimation.studies.arm_study import StudiedArm
import numpy as np
import pytest

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
    ours, theirs = RobotModel(text, base, TIP), mujoco_model(text, 1e-3)
    data, rng = mujoco().MjData(theirs), np.random.default_rng(5)
    for _ in range(20):
        q, q_dot = rng.uniform(-2.5, 2.5, theirs.nq), rng.normal(size=theirs.nv)
        data.qpos[:] = q
        mujoco().mj_forward(theirs, data)
        J, site = np.zeros((6, theirs.nv)), data.site(TIP)
        mujoco().mj_jacSite(theirs, data, J[:3], J[3:], theirs.site(TIP).id)
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
        model = mujoco_arm(urdf, arm)
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
