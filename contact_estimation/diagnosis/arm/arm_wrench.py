# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The wrench of an arm in contact, as its sensor at a link feels the environment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ...kinematics.arm_dynamics import ArmDynamics, Outside
from ...kinematics.tool_load import load_map
from ...pipeline.parameters import EstimationParameters

Array = NDArray[np.float64]

_FELT_N = 1.0
_PRESSING = 90.0  # percentile of the force, beyond which its direction is the normal


@dataclass(frozen=True, eq=False)
class ArmWrench:
    """Measured wrenches of an arm at the times of its joint states."""

    frame: str  # link of the sensor
    measured: Array  # (N, 6) as published [N], [N m]
    # of sensor and tool: `force_sign`, `force_sensor.*`, `tool.*`
    parameters: EstimationParameters

    def outside(self, arm: ArmDynamics, q: Array) -> Outside:
        """Return what acts on the arm: without the tool's weight, in axes of the sensor's link."""
        sensor = self.parameters.force_sensor
        mount, axes = Rotation.from_euler('xyz', sensor.rpy).as_matrix(), arm.axes(q, self.frame)
        turned = axes @ mount
        both = self.parameters.force_sign * self.measured.reshape(-1, 2, 3)
        if sensor.axes == 'base':
            both = both @ turned
        load, bias = load_map(self.parameters.tool)
        down = turned.transpose(0, 2, 1) @ arm.model.gravity.linear
        own = both.reshape(-1, 6) - bias - down @ load.T
        return Outside(self.frame, (own.reshape(-1, 2, 3) @ mount.T).reshape(-1, 6))


def pressed_along(arm: ArmDynamics, q: Array, outside: Outside) -> Array:
    """Return the direction in which an arm presses most, in axes of the root; 0 for none, (3,)."""
    force = np.einsum('nij,nj->ni', arm.axes(q, outside.frame), outside.wrench[:, :3])
    size = np.linalg.norm(force, axis=1)
    most = -force[size >= np.percentile(size, _PRESSING)].mean(axis=0)
    length = float(np.linalg.norm(most))
    return np.asarray(most / length if length > _FELT_N else np.zeros(3))
