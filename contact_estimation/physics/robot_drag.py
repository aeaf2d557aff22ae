# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Drag of the robot that grows with the square of its speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .drawn_effect import Scales
from .numeric import Number
from .robot_effect import RobotEffect
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class RobotDragParameters(ParameterGroup):
    """Parameters of `RobotDrag`."""

    c: float = optional_parameter('Drag of the robot at 1 m/s', 'N s^2/m^2', minimum=0.0)


class RobotDrag(RobotEffect):
    """
    -c xd |xd| added to the motion of the robot.

    Fluid drag, or churning of grease and oil in its gears (Batchelor, An Introduction to Fluid
    Dynamics, 1967).
    """

    name = 'robot_drag'
    equation = "M_t x'' = u - c x' |x'| + F_e"
    family = 'robot'
    description = 'Drag proportional to the square of the speed opposes the motion of the robot.'
    Parameters = RobotDragParameters

    def drag(self, velocity: Number, m: Any) -> Number:
        """Return c xd |xd|; see `RobotEffect.drag`."""
        return self.values.c * velocity * abs(velocity)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in c."""
        return [(0.01 * scales.force / scales.speed**2,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return c whose drag at the largest speed is half the largest force."""
        return 0.5 * scales.force / scales.speed**2
