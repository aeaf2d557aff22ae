# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Eq. (6): the force of several contact points on one tool, as pure functions.

The points share K_e and B_e. Each has a surface with a normal from wall to robot, presses
independently and slides with friction:
F_e = sum_i F_ni (n_i - mu s_i), F_ni = K_e delta_i + B_e deltadot_i.
A robot that presses along +x against one point has n = (-1, 0, 0), which is eq. (3).
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..exceptions import ParameterRangeError, SignalShapeError

Array = NDArray[np.float64]
SLIP_SPEED = 4e-4  # [m/s]; below it friction grows linearly, as in all effects of this package


@dataclass(frozen=True)
class ContactGeometry:
    """Contact points of the tool, and the plane that each of them may touch."""

    points: Array  # (N, 3) positions in the frame of the tool [m]
    # (N, 3) one position on the surface of each point, in the frame of the force [m]
    surfaces: Array
    normals: Array  # (N, 3) unit vectors n_i from wall to robot, in the frame of the force

    def __post_init__(self) -> None:
        """Check shapes and normals."""
        for name in ('points', 'surfaces', 'normals'):
            array = np.asarray(getattr(self, name), float)
            object.__setattr__(self, name, array)
            if array.ndim != 2 or array.shape[1] != 3 or array.shape != self.points.shape:
                raise SignalShapeError(
                    f'{name} must have a row of 3 numbers for each contact point, shape (N, 3) '
                    f'as points {self.points.shape}, got {array.shape}')
        lengths = np.linalg.norm(self.normals, axis=1)
        if not np.allclose(lengths, 1.0, atol=1e-6):
            raise ParameterRangeError(
                f'normals must have length 1, got lengths {lengths.tolist()}; divide by them')


class ToolMotion(NamedTuple):
    """Pose and twist of the tool in the frame of the force."""

    position: Array  # (3,) position of the tool's origin [m]
    rotation: Array  # (3, 3) from the frame of the tool to the frame of the force
    velocity: Array  # (3,) velocity of the tool's origin [m/s]
    angular_velocity: Array  # (3,) angular velocity in the frame of the force [rad/s]


class PointMotions(NamedTuple):
    """Motion of every contact point relative to its surface."""

    delta: Array  # (N,) penetration [m], positive in contact
    delta_dot: Array  # (N,) its rate [m/s]
    slip: Array  # (N, 3) velocity along the surface [m/s]


def point_motions(geometry: ContactGeometry, motion: ToolMotion) -> PointMotions:
    """Compute penetrations, their rates and the slip from pose and twist of a rigid tool."""
    # delta_i = n_i . (surface_i - p_i), deltadot_i = -n_i . v_i, v_i = v + omega x (R r_i).
    normals = geometry.normals
    arms = geometry.points @ motion.rotation.T  # (N, 3) [m]
    velocities = motion.velocity + np.cross(motion.angular_velocity, arms)  # (N, 3) [m/s]
    outward = np.sum(normals * velocities, axis=1)  # (N,) [m/s]
    delta = np.sum(normals * (geometry.surfaces - motion.position - arms), axis=1)
    return PointMotions(delta, -outward, velocities - outward[:, None] * normals)


def slip_directions(slip: Array) -> Array:
    """
    Compute the smoothed direction s_i of sliding: tanh(|v| / 4e-4 m/s) v / |v|.

    slip (N, 3): velocity along the surface [m/s]
    Returns directions (N, 3): unit length while sliding, 0 at rest
    """
    speed = np.linalg.norm(slip, axis=1, keepdims=True)  # (N, 1) [m/s]
    share = np.tanh(speed / SLIP_SPEED) / np.where(speed > 0.0, speed, 1.0)
    return slip * share


def frictionless_directions(geometry: ContactGeometry, sticking: NDArray[np.bool_]) -> Array:
    """
    Return the directions in which friction of sticking points cannot act.

    At rest, friction is an unknown force of up to mu F_n along the surface. One sticking point
    leaves its normal, two of one surface the same, two of different surfaces no direction.

    sticking (N,): points that press without sliding
    Returns directions (M, 3): orthonormal rows, M from 0 to 3
    """
    normals = geometry.normals[sticking]  # (S, 3)
    along = len(normals) * np.eye(3) - normals.T @ normals  # sum of projectors on the surfaces
    shares, directions = np.linalg.eigh(along)
    return directions.T[shares < 1e-9]


def force_regressor(
    geometry: ContactGeometry, motions: PointMotions, touching: NDArray[np.bool_]
) -> Array:
    """
    Return Phi of eq. (6) written as F_e = Phi (K_e, B_e, mu K_e, mu B_e)^T.

    touching (N,): points in contact; the others do not contribute
    Returns Phi (3, 4): [sum delta_i n_i, sum deltadot_i n_i, -sum delta_i s_i, -sum deltadot_i
    s_i]
    """
    pressing = np.stack([motions.delta, motions.delta_dot]) * touching  # (2, N) [m], [m/s]
    along = pressing @ geometry.normals  # (2, 3)
    rubbing = pressing @ slip_directions(motions.slip)  # (2, 3)
    return np.concatenate([along, -rubbing]).T
