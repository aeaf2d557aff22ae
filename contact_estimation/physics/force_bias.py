# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Bias of the force sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .drawn_effect import Scales
from .force_sensor_effect import ForceSensorEffect
from .numeric import Array, Number
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ForceBiasParameters(ParameterGroup):
    """Parameters of `ForceBias`."""

    bias: float = optional_parameter('Measured force without load', 'N')


class ForceBias(ForceSensorEffect):
    """F + bias."""

    name = 'force_bias'
    equation = 'F_measured = F_e + bias'
    family = 'sensor_zero'
    description = 'The force sensor was not tared: a constant is added to the force.'
    Parameters = ForceBiasParameters
    either_sign = True

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Add the bias; see `ForceSensorEffect.sense`."""
        return force + float(self.values.bias)

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Add the bias; see `ForceSensorEffect.sense_along`."""
        return np.asarray(force + self.values.bias)

    def undo(self, t: Number, measured: Number) -> Number:
        """Subtract the bias; see `ForceSensorEffect.undo`."""
        return measured - self.values.bias

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in bias."""
        return [(0.002 * scales.force,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return 0.3 times the largest force."""
        return 0.3 * scales.force
