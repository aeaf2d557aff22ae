# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Robot whose impedance differs from the target impedance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .drawn_effect import random_sign, Scales, Strength
from .robot_effect import RobotEffect
from ..parameters.specification import optional_parameter, ParameterGroup

_ALIKE = 0.3  # of their mean deviation from 1: less between the scales is one for all


@dataclass(frozen=True)
class ImpedanceMismatchParameters(ParameterGroup):
    """Parameters of `ImpedanceMismatch`."""

    K_t_scale: float = optional_parameter(
        'Stiffness of the robot divided by K_t', '1', minimum=0.0)
    B_t_scale: float = optional_parameter('Damping of the robot divided by B_t', '1', minimum=0.0)
    M_t_scale: float = optional_parameter('Mass of the robot divided by M_t', '1', minimum=0.01)


class ImpedanceMismatch(RobotEffect):
    """actual = scale x nominal, for M_t, B_t and K_t."""

    name = 'impedance_mismatch'
    equation = 'M_t_scale M_t, B_t_scale B_t, K_t_scale K_t in eq. (1)'
    family = 'robot'
    description = 'The robot realises a mass, damping or stiffness other than the target.'
    Parameters = ImpedanceMismatchParameters
    neutral = {'K_t_scale': 1.0, 'B_t_scale': 1.0, 'M_t_scale': 1.0}

    def __init__(self, values: ImpedanceMismatchParameters) -> None:
        super().__init__(values)
        self.stiffness_scale = values.K_t_scale
        self.damping_scale = values.B_t_scale
        self.mass_scale = values.M_t_scale

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """Is always one: three scales follow any misfit in position, velocity and acceleration."""
        return True

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Return whether the scales differ: all alike are the gain of the force sensor."""
        scales = (values.K_t_scale, values.B_t_scale, values.M_t_scale)
        return max(scales) - min(scales) > _ALIKE * abs(sum(scales) / 3.0 - 1.0)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: nearly linear."""
        return [(1.002, 1.002, 1.002)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw the relative deviation of each parameter."""
        names = ('K_t_scale', 'B_t_scale', 'M_t_scale')
        shares = [0.5 * random_sign(rng) * float(rng.uniform(0.3, 1.0)) for _ in names]
        return lambda s: {name: 1.0 + s * share for name, share in zip(names, shares)}
