# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Coulomb friction of the robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .drawn_effect import Scales
from .numeric import Number
from .robot_effect import RobotEffect
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class RobotFrictionParameters(ParameterGroup):
    """Parameters of `RobotFriction`."""

    F_c: float = optional_parameter('Dry friction force of the robot', 'N', minimum=0.0)


class RobotFriction(RobotEffect):
    """-F_c sgn(xd) added to the motion of the robot."""

    name = 'robot_friction'
    equation = "M_t x'' = u - F_c sgn(x') + F_e"
    family = 'robot'
    description = 'Dry friction in the joints of the robot opposes its motion.'
    Parameters = RobotFrictionParameters

    def drag(self, velocity: Number, m: Any) -> Number:
        """Return F_c sgn(xd); see `RobotEffect.drag`."""
        return self.values.F_c * m.tanh(velocity / self.sign_velocity)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in F_c."""
        return [(0.002 * scales.force,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return 0.6 times the largest force."""
        return 0.6 * scales.force
