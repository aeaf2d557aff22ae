# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Pose and Jacobian of an arm against hand-written transforms and finite differences."""

from __future__ import annotations

import sys

from contact_estimation.exceptions import MissingPackageError, ModelFileError, UnknownNameError
from contact_estimation.kinematics.robot_model import RobotModel
import numpy as np
import pytest
from small_arm import JOINTS, pose, urdf

Q = (0.3, -0.4, 2.7)
Q_DOT = np.array([0.5, -1.1, 0.7])


@pytest.fixture(scope='module')
def model() -> RobotModel:
    pytest.importorskip('pinocchio')
    return RobotModel(urdf(), 'base_link', 'tool')


@pytest.mark.parametrize('frame', ['tool', 'sensor', 'link_2', 'base_link'])
@pytest.mark.parametrize('q', [Q, (-2.0, 9.0, 0.1)])
def test_pose_is_the_product_of_the_transforms(
    model: RobotModel, frame: str, q: tuple[float, ...]
) -> None:
    R, p = model.pose(q, frame)
    expected = pose(q, frame)
    np.testing.assert_allclose(R, expected[:3, :3], atol=1e-12)
    np.testing.assert_allclose(p, expected[:3, 3], atol=1e-12)


def test_jacobian_is_the_derivative_of_the_pose(model: RobotModel) -> None:
    step = 1e-3
    columns = []
    for joint in np.eye(3):  # five-point formula: error of the order of step^4
        T = {k: pose(tuple(np.array(Q) + k * step * joint)) for k in (-2, -1, 1, 2)}
        rate = (8 * (T[1] - T[-1]) - (T[2] - T[-2])) / (12 * step)
        turning = rate[:3, :3] @ pose(Q)[:3, :3].T
        columns.append([*rate[:3, 3], turning[2, 1], turning[0, 2], turning[1, 0]])
    np.testing.assert_allclose(model.jacobian(Q), np.array(columns).T, atol=1e-9)


def test_only_the_joints_between_base_and_tip_are_asked_for(model: RobotModel) -> None:
    assert model.joint_names == JOINTS
    assert model.continuous == (False, True, False)
    assert RobotModel(urdf(), 'link_1', 'tool').joint_names == JOINTS[1:]


@pytest.mark.parametrize('base, tip, text', [
    ('base_link', 'tol', "unknown link .* 'tol'; did you mean 'tool'"),
    ('world', 'base_link', 'no joint moves kinematics.tip'),
    ('finger', 'tool', 'finger_joint moves the base and not the tip'),
])
def test_frames_that_cannot_serve_are_named(base: str, tip: str, text: str) -> None:
    pytest.importorskip('pinocchio')
    with pytest.raises((ModelFileError, UnknownNameError), match=text):
        RobotModel(urdf(), base, tip)


def test_a_text_that_is_no_description_is_an_error() -> None:
    pytest.importorskip('pinocchio')
    with pytest.raises(ModelFileError, match='must be a URDF'):
        RobotModel('$(find arm)/arm.xacro', 'base_link', 'tool')


def test_a_missing_library_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, 'pinocchio', None)
    with pytest.raises(MissingPackageError, match=r'contact_estimation\[robots\].*ros-jazzy-pin'):
        RobotModel(urdf(), 'base_link', 'tool')
