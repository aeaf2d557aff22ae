# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Delay of the force signal."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np

from .drawn_effect import Scales
from .force_sensor_effect import ForceSensorEffect
from .numeric import Array
from ..parameters.specification import optional_parameter, ParameterGroup

_SLOWEST_S = 0.5  # of a force sensor


@dataclass(frozen=True)
class ForceDelayParameters(ParameterGroup):
    """Parameters of `ForceDelay`."""

    delay: float = optional_parameter('Delay of the force', 's', minimum=0.0)


class ForceDelay(ForceSensorEffect):
    """F(t - delay)."""

    name = 'force_delay'
    equation = 'F_measured(t) = F_e(t - delay)'
    family = 'timing'
    description = 'The force signal is delayed relative to the motion.'
    Parameters = ForceDelayParameters
    sampled_delay = 'delay'

    memory = True

    def __init__(self, values: ForceDelayParameters) -> None:
        super().__init__(values)
        self._past: deque[tuple[float, float]] = deque()

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Interpolate past samples linearly; see `ForceSensorEffect.sense`."""
        past, then = self._past, t - self.values.delay
        past.append((t, force))
        while len(past) > 1 and past[1][0] <= then:
            past.popleft()
        (t_0, f_0), (t_1, f_1) = past[0], past[min(1, len(past) - 1)]
        if then <= t_0 or t_1 <= t_0:
            return f_0
        return f_0 + (f_1 - f_0) * (then - t_0) / (t_1 - t_0)

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Interpolate past samples linearly; see `ForceSensorEffect.sense_along`."""
        return np.interp(t - self.values.delay, t, force)

    def undo_along(self, t: Array, measured: Array) -> Array:
        """Interpolate future samples linearly; see `ForceSensorEffect.undo_along`."""
        return np.interp(t + self.values.delay, t, measured)

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Return whether a sensor can be so slow; a specimen that relaxes looks the same."""
        return bool(values.delay < _SLOWEST_S)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread the delay."""
        return [(delay,) for delay in scales.delays()]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return 0.1 s."""
        return 0.1
