# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Saturation of the drives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .drawn_effect import Scales, Strength
from .numeric import Number, positive
from .robot_effect import RobotEffect
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ActuatorSaturationParameters(ParameterGroup):
    """Parameters of `ActuatorSaturation`."""

    limit: float = optional_parameter('Largest force of the drives', 'N', minimum=0.0)


class ActuatorSaturation(RobotEffect):
    """The control force u clipped to +-limit."""

    name = 'actuator_saturation'
    equation = "M_t x'' = clip(u, +-limit) + F_e"
    family = 'limits'
    description = 'The drives cannot deliver the commanded force.'
    Parameters = ActuatorSaturationParameters

    def control(self, u: Number, m: Any) -> Number:
        """Clip u; see `RobotEffect.control`."""
        limit = self.values.limit
        return positive(u + limit, m) - positive(u - limit, m) - limit

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread the limit below the greatest control force."""
        return [(share * scales.control,) for share in (0.3, 0.5, 0.7, 0.85, 0.96)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Lower the limit to a fifth of the largest control force; nothing else is random."""
        return lambda s: {'limit': (1.0 - 0.8 * s) * scales.control}
