# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Drift of the force sensor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .drawn_effect import Scales
from .force_sensor_effect import ForceSensorEffect
from .numeric import Array, Number
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ForceDriftParameters(ParameterGroup):
    """Parameters of `ForceDrift`."""

    rate: float = optional_parameter('Rate of change of the measured force without load', 'N/s')


class ForceDrift(ForceSensorEffect):
    """F + rate t."""

    name = 'force_drift'
    equation = 'F_measured = F_e + rate t'
    family = 'sensor_zero'
    needs_return = True  # of one stroke and a hold, time tells what relaxes, too
    description = 'The zero of the force sensor drifts linearly with time.'
    Parameters = ForceDriftParameters
    either_sign = True

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Add the drift; see `ForceSensorEffect.sense`."""
        return force + float(self.values.rate) * t

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Add the drift; see `ForceSensorEffect.sense_along`."""
        return np.asarray(force + self.values.rate * t)

    def undo(self, t: Number, measured: Number) -> Number:
        """Subtract the drift; see `ForceSensorEffect.undo`."""
        return measured - self.values.rate * t

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """Is one."""
        return True

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in rate."""
        return [(0.002 * scales.force / scales.duration,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return the rate that adds half the largest force over the recording."""
        return 0.5 * scales.force / scales.duration
