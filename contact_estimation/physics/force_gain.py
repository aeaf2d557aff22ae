# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Wrong sensitivity of the force sensor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.random import Generator

from .drawn_effect import random_sign, Scales, Strength
from .force_sensor_effect import ForceSensorEffect
from .numeric import Array, Number
from ..parameters.specification import optional_parameter, ParameterGroup

CALIBRATED = 0.05
"""Relative error of the sensitivity that is usual."""


@dataclass(frozen=True)
class ForceGainParameters(ParameterGroup):
    """Parameters of `ForceGain`."""

    gain: float = optional_parameter('Measured over true force', '1', minimum=0.01)


class ForceGain(ForceSensorEffect):
    """
    gain F.

    K_e and B_e make up for it in the force; the motion of a robot, which feels the true force,
    tells it. It is the same as an impedance of which M_t, B_t and K_t are all 1 / gain of the
    target.
    """

    name = 'force_gain'
    equation = 'F_measured = gain F_e'
    family = 'sensor_gain'
    description = 'The sensitivity of the force sensor is not that of its calibration.'
    Parameters = ForceGainParameters
    rescales_wall = True
    neutral = {'gain': 1.0}
    needs_robot = True

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Multiply by the gain; see `ForceSensorEffect.sense`."""
        return force * float(self.values.gain)

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Multiply by the gain; see `ForceSensorEffect.sense_along`."""
        return np.asarray(force * self.values.gain)

    def undo(self, t: Number, measured: Number) -> Number:
        """Divide by the gain; see `ForceSensorEffect.undo`."""
        return measured / self.values.gain

    @classmethod
    def exceeds_calibration(cls, values: Any, force: float) -> bool:
        """Return whether sensor or robot are off by more than is usual."""
        return bool(abs(values.gain - 1.0) >= CALIBRATED)

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """Is always one: it lets force and motion each have a wall of its own."""
        return True

    @classmethod
    def wall_scale(cls, values: Any) -> float:
        """Return 1 / gain: the product of it and K_e is known far better than either."""
        return float(1.0 / values.gain)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread the gain."""
        return [(gain,) for gain in (0.5, 0.65, 0.85, 1.15, 1.4, 1.8)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw a gain on either side of 1, beyond the calibration."""
        sign = random_sign(rng)
        return lambda s: {'gain': 1.0 + sign * (1.1 * CALIBRATED + 0.4 * s)}
