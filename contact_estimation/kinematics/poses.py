# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Poses as seven plain numbers, which cost less than arrays at the rate of a robot."""

from __future__ import annotations

from math import sqrt
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

Pose = Sequence[float]
"""Origin x, y, z of a frame in its parent [m], unit quaternion x, y, z, w of its axes."""

IDENTITY: Pose = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def rotated(pose: Pose, x: float, y: float, z: float) -> tuple[float, float, float]:
    """
    Return a vector of the child in the axes of the parent.

    v' = v + w t + u x t with t = 2 u x v, u the vector part of the quaternion.

    """
    a, b, c, w = pose[3], pose[4], pose[5], pose[6]
    t, u, s = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
    return (x + w * t + b * s - c * u, y + w * u + c * t - a * s, z + w * s + a * u - b * t)


def product(first: Pose, second: Pose) -> Pose:
    """Return the pose of a frame in the grandparent."""
    x, y, z = rotated(first, second[0], second[1], second[2])
    a, b, c, d = first[3], first[4], first[5], first[6]
    e, f, g, h = second[3], second[4], second[5], second[6]
    return (
        first[0] + x, first[1] + y, first[2] + z,
        d * e + a * h + b * g - c * f,
        d * f - a * g + b * h + c * e,
        d * g + a * f - b * e + c * h,
        d * h - a * e - b * f - c * g,
    )


def inverse(pose: Pose) -> Pose:
    """Return the pose of the parent in the child."""
    turned = (0.0, 0.0, 0.0, -pose[3], -pose[4], -pose[5], pose[6])
    x, y, z = rotated(turned, pose[0], pose[1], pose[2])
    return (-x, -y, -z, *turned[3:])


def normalised(pose: Pose) -> Pose:
    """Return a pose with a unit quaternion; of two interpolated ones, the length is below 1."""
    a, b, c, d = pose[3], pose[4], pose[5], pose[6]
    scale = 1.0 / sqrt(a * a + b * b + c * c + d * d)
    return (pose[0], pose[1], pose[2], a * scale, b * scale, c * scale, d * scale)


def matrix_of(pose: Pose) -> NDArray[np.float64]:
    """Return the axes of the child as columns in the parent, shape (3, 3)."""
    a, b, c, d = pose[3], pose[4], pose[5], pose[6]
    return np.array([
        [1.0 - 2.0 * (b * b + c * c), 2.0 * (a * b - c * d), 2.0 * (a * c + b * d)],
        [2.0 * (a * b + c * d), 1.0 - 2.0 * (a * a + c * c), 2.0 * (b * c - a * d)],
        [2.0 * (a * c - b * d), 2.0 * (b * c + a * d), 1.0 - 2.0 * (a * a + b * b)],
    ])
