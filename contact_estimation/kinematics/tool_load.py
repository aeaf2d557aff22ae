# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The load of the tool on a force/torque sensor: weight, inertia and the sensor's zero.

A sensor at the wrist measures the wrench that the environment applies to the end-effector (eq. 3)
and the tool beyond it: with m the mass of the tool and c its centre of gravity in the sensor's
frame, f = R^T (g - a) the weight per mass less the acceleration a of the sensor's origin, w and
alpha the angular velocity and acceleration, all in the sensor's frame,

    force  = F_e + m f - A m c + b_F        A = [alpha]x + [w]x [w]x
    torque = T_e + m c x f     + b_T        about the sensor's origin

R turns the sensor's frame into one whose z points up, and g = (0, 0, -9.80665) m/s^2: a tool hung
below a resting sensor adds m g downwards. A driver that publishes the wrench that the robot
applies has the opposite sign and is corrected before. The moments of inertia about the centre
(I alpha + w x I w) are not modelled: at rest and in slow motion they are negligible.

Without the external wrench this is linear in (m, m c, b_F, b_T), and calibration fits what
compensation subtracts: both use `load_regressor`.

Source: Kubus, Kroeger, Wahl, *On-line rigid object recognition and pose estimation based on
inertial parameters*, IROS 2007, eqs. (4) to (8).

"""

from dataclasses import dataclass

import numpy as np

from .robot_model import Array
from ..parameters import parameter, ParameterGroup

STANDARD_GRAVITY = 9.80665
"""In [m/s^2]; the mass found absorbs the local deviation of up to 0.3 %."""

_G = np.array([0.0, 0.0, -STANDARD_GRAVITY])


@dataclass(frozen=True)
class ToolParameters(ParameterGroup):
    """Load of the tool on the force sensor, taken out of the measured wrench."""

    mass: float = parameter(
        0.0, 'Mass of everything beyond the force sensor, as calibrate_tool finds it', 'kg',
        minimum=0.0, maximum=1000.0)
    centre: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0), "Centre of gravity of the tool in the force sensor's frame", 'm')
    force_bias: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0), 'Force that the sensor reads without any load', 'N')
    torque_bias: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0), 'Torque that the sensor reads without any load', 'N m')

    @property
    def is_on(self) -> bool:
        """Whether there is any load to take out."""
        return self.mass > 0.0 or any(self.force_bias) or any(self.torque_bias)


def specific_force(R: Array, acceleration: Array | None = None) -> Array:
    """Compute f = R^T (g - a), (..., 3): the weight per mass as the sensor feels it [m/s^2]."""
    rest = _G if acceleration is None else _G - acceleration
    return np.einsum('...ji,...j->...i', R, rest)


def load_regressor(f: Array, w: Array | None = None, alpha: Array | None = None) -> Array:
    """Compute Phi (..., 6, 10), which turns (m, m c, b_F, b_T) into the wrench of the tool."""
    Phi = np.zeros((*f.shape[:-1], 6, 10))
    Phi[..., :3, 0] = f
    if alpha is not None:
        Phi[..., :3, 1:4] -= cross_matrix(alpha)
    if w is not None:
        W = cross_matrix(w)
        Phi[..., :3, 1:4] -= W @ W
    Phi[..., 3:, 1:4] = -cross_matrix(f)  # m c x f = -f x m c
    Phi[..., :, 4:] = np.eye(6)
    return Phi


def load_vector(tool: ToolParameters) -> Array:
    """Return (m, m c, b_F, b_T), shape (10,), of the parameters."""
    return np.concatenate((
        [tool.mass], tool.mass * np.asarray(tool.centre), tool.force_bias, tool.torque_bias))


def load_map(tool: ToolParameters) -> tuple[Array, Array]:
    """Return L (6, 3) and bias (6,): without rotation the tool's wrench is L f + bias."""
    theta = load_vector(tool)
    bias = load_regressor(np.zeros(3)) @ theta
    return (load_regressor(np.eye(3)) @ theta - bias).T, bias


def cross_matrix(v: Array) -> Array:
    """Return [v]x, shape (..., 3, 3), of vectors of shape (..., 3): [v]x u = v x u."""
    x, y, z = np.moveaxis(np.asarray(v, np.float64), -1, 0)
    o = np.zeros_like(x)
    return np.stack((o, -z, y, z, o, -x, -y, x, o), axis=-1).reshape(*x.shape, 3, 3)
