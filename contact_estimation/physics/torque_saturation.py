# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Drives whose force grows less and less with the commanded one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .drawn_effect import Scales, Strength
from .numeric import Number
from .robot_effect import RobotEffect
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class TorqueSaturationParameters(ParameterGroup):
    """Parameters of `TorqueSaturation`."""

    limit: float = optional_parameter('Force that the drives approach', 'N', minimum=1e-9)


class TorqueSaturation(RobotEffect):
    """
    The control force limit tanh(u / limit).

    Iron saturates, and torque falls behind current (Hughes and Drury, Electric Motors and Drives,
    2019). A limit of the controller clips instead, see `ActuatorSaturation`.
    """

    name = 'torque_saturation'
    equation = "M_t x'' = limit tanh(u / limit) + F_e"
    family = 'limits'
    description = 'The drives deliver less and less of a growing control force.'
    Parameters = TorqueSaturationParameters
    in_logarithm = ('limit',)

    def control(self, u: Number, m: Any) -> Number:
        """Bend u; see `RobotEffect.control`."""
        limit = self.values.limit
        return limit * m.tanh(u / limit)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread the limit about the greatest control force."""
        return [(share * scales.control,) for share in (0.8, 1.5, 3.0, 8.0)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Lower the limit to half of the largest control force; nothing else is random."""
        return lambda s: {'limit': scales.control / (2.0 * max(s, 1e-3))}
