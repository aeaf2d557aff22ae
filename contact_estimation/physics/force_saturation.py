# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Saturation of the force sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from .drawn_effect import Scales, Strength
from .force_sensor_effect import ForceSensorEffect
from .numeric import Array
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ForceSaturationParameters(ParameterGroup):
    """Parameters of `ForceSaturation`."""

    limit: float = optional_parameter('End of the measuring range', 'N', minimum=0.0)


class ForceSaturation(ForceSensorEffect):
    """F clipped to +-limit."""

    name = 'force_saturation'
    equation = 'F_measured = clip(F_e, +-limit)'
    family = 'limits'
    description = 'The force signal is clipped at the end of the measuring range.'
    Parameters = ForceSaturationParameters
    clips_force = True

    def __init__(self, values: ForceSaturationParameters) -> None:
        super().__init__(values)
        self.limit = values.limit

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Clip; see `ForceSensorEffect.sense`."""
        limit = float(self.values.limit)
        return min(limit, max(-limit, force))

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Clip; see `ForceSensorEffect.sense_along`."""
        return np.clip(force, -self.values.limit, self.values.limit)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread the limit below the greatest force."""
        return [(share * scales.force,) for share in (0.4, 0.6, 0.75, 0.87, 0.96)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Lower the limit to a fifth of the largest force; nothing else is random."""
        return lambda s: {'limit': (1.0 - 0.8 * s) * scales.force}
