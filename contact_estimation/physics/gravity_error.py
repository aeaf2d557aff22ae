# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Constant force on the robot: gravity that its control compensates wrongly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .drawn_effect import Scales
from .numeric import Number
from .robot_effect import RobotEffect
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class GravityErrorParameters(ParameterGroup):
    """Parameters of `GravityError`."""

    F_g: float = optional_parameter('Force towards the wall that is not compensated', 'N')


class GravityError(RobotEffect):
    """
    F_g added to the motion of the robot.

    What is left of gravity where the control compensates for another mass, such as that of a
    payload it does not know (Siciliano, Sciavicco, Villani and Oriolo, Robotics, 2009, section
    8.5). At rest the robot is off by F_g / K_t.
    """

    name = 'gravity_error'
    equation = "M_t x'' = u + F_g + F_e"
    family = 'robot'
    description = 'Gravity, compensated wrongly, pushes the robot with a constant force.'
    Parameters = GravityErrorParameters

    def drag(self, velocity: Number, m: Any) -> Number:
        """Return -F_g; see `RobotEffect.drag`."""
        return 0.0 * velocity - self.values.F_g

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in F_g."""
        return [(0.01 * scales.force,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return a force of half the largest contact force."""
        return 0.5 * scales.force
