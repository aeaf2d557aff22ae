# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The load of the tool on the sensor, against Newton's law of a point mass."""

from __future__ import annotations

from contact_estimation.kinematics.tool_load import STANDARD_GRAVITY, tool_wrench, ToolParameters
import numpy as np
from scipy.spatial.transform import Rotation

TOOL = ToolParameters(
    mass=1.2, centre=(0.01, -0.02, 0.06), force_bias=(1.0, -2.0, 3.0),
    torque_bias=(0.1, 0.2, -0.3),
)
w0, w1 = np.array([0.5, -1.0, 2.0]), np.array([-3.0, 1.5, 0.7])


def orientation(t: float) -> Rotation:
    """Return an accelerating rotation."""
    return Rotation.from_rotvec(w0 * t) * Rotation.from_rotvec(w1 * t * t)


def origin(t: float) -> np.ndarray:
    """Return an accelerating position of the sensor [m]."""
    return np.array([np.sin(3 * t), t**3, np.cos(2 * t)])


def second_difference(function: object, t: float, h: float = 1e-3) -> np.ndarray:
    """Return the second derivative by central differences of fourth order."""
    weights = zip((-2, -1, 0, 1, 2), (-1, 16, -30, 16, -1))
    return sum(k * function(t + i * h) for i, k in weights) / (12 * h * h)  # type: ignore


def angular_velocity(t: float, h: float = 1e-4) -> np.ndarray:
    """Return the angular velocity in the moving frame by central differences [rad/s]."""
    return (orientation(t - h).inv() * orientation(t + h)).as_rotvec() / (2 * h)


def test_force_in_any_motion_is_that_of_a_point_mass_at_the_centre() -> None:
    t, R = 0.4, orientation(0.4).as_matrix()
    centre_acceleration = second_difference(
        lambda s: origin(s) + orientation(s).apply(TOOL.centre), t)
    gravity = np.array([0.0, 0.0, -STANDARD_GRAVITY])
    expected = R.T @ (TOOL.mass * (gravity - centre_acceleration)) + TOOL.force_bias
    alpha = (angular_velocity(t + 1e-4) - angular_velocity(t - 1e-4)) / 2e-4
    wrench = tool_wrench(TOOL, R, second_difference(origin, t), angular_velocity(t), alpha)
    np.testing.assert_allclose(wrench[:3], expected, atol=1e-5)


def test_torque_at_rest_is_that_of_the_weight_at_the_centre() -> None:
    R = orientation(0.3).as_matrix()
    weight = R.T @ [0.0, 0.0, -TOOL.mass * STANDARD_GRAVITY]
    expected = np.cross(TOOL.centre, weight) + TOOL.torque_bias
    np.testing.assert_allclose(tool_wrench(TOOL, R)[3:], expected, atol=1e-12)
