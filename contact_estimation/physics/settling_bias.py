# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Sensor zero that settles: the measured force is off by a decaying amount."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp
from typing import Any

import numpy as np
from numpy.random import Generator

from .drawn_effect import log_uniform, random_sign, Scales, Strength
from .force_sensor_effect import ForceSensorEffect
from .numeric import Array, Number
from ..parameters.specification import optional_parameter, ParameterGroup

_LONGEST = 2.0  # time constant, in the duration of the recording


@dataclass(frozen=True)
class SettlingBiasParameters(ParameterGroup):
    """Parameters of `SettlingBias`."""

    change: float = optional_parameter('Bias at the first sample less that in the end', 'N')
    tau: float = optional_parameter('Time constant of the settling', 's', minimum=0.001)
    bias: float = optional_parameter('Bias in the end', 'N')


class SettlingBias(ForceSensorEffect):
    """F + bias + change exp(-t / tau)."""

    name = 'settling_bias'
    equation = 'F_measured = F_e + bias + change exp(-t / tau)'
    family = 'sensor_zero'
    description = 'The zero of the force sensor settles exponentially, as after switching on.'
    Parameters = SettlingBiasParameters
    needs_return = True
    linear_in = ('change', 'bias')
    either_sign = True

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Add the bias; see `ForceSensorEffect.sense`."""
        p = self.values
        return force + float(p.bias + p.change * exp(-t / p.tau))

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Add the bias; see `ForceSensorEffect.sense_along`."""
        return np.asarray(force + self._at(t))

    def undo(self, t: Number, measured: Number) -> Number:
        """Subtract the bias; see `ForceSensorEffect.undo`."""
        return measured - self._at(t)

    def _at(self, t: Number) -> Any:
        p = self.values
        return p.bias + p.change * np.exp(-t / p.tau)

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """Is one."""
        return True

    @classmethod
    def is_resolved(cls, values: Any, duration: float) -> bool:
        """Need a bend: what settles much more slowly than the recording ends drifts."""
        return bool(values.tau <= _LONGEST * duration)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread tau; the law is linear in the others."""
        F = 0.02 * scales.force
        return [(F, share * scales.duration, 0.0) for share in (0.1, 0.25, 0.6)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw tau, and the sign of the change."""
        tau, most = log_uniform(rng, 0.1, 0.4) * scales.duration, 0.5 * scales.force
        most *= random_sign(rng)
        return lambda s: {'change': s * most, 'tau': tau, 'bias': 0.3 * s * most}
