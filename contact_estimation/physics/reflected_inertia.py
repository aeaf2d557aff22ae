# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Inertia of rotors and gears."""

from __future__ import annotations

from dataclasses import dataclass

from .drawn_effect import Scales
from .robot_effect import RobotEffect
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ReflectedInertiaParameters(ParameterGroup):
    """Parameters of `ReflectedInertia`."""

    M_r: float = optional_parameter(
        'Inertia that the feed-forward does not compensate', 'kg', minimum=0.0)


class ReflectedInertia(RobotEffect):
    """(M_t + M_r) x'' in the motion; the feed-forward has M_t alone."""

    name = 'reflected_inertia'
    equation = "(M_t + M_r) x'' = u + F_e"
    family = 'inertia'
    description = 'Inertia of rotors and gears that the feed-forward does not compensate.'
    Parameters = ReflectedInertiaParameters

    def __init__(self, values: ReflectedInertiaParameters) -> None:
        super().__init__(values)
        self.reflected_inertia = values.M_r

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: nearly linear."""
        return [(0.002 * scales.mass,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return the target mass of the robot."""
        return scales.mass
