# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Low-pass filter in the force sensor."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp
from typing import Any

import numpy as np

from .drawn_effect import Scales
from .force_sensor_effect import ForceSensorEffect
from .numeric import Array
from ..parameters.specification import optional_parameter, ParameterGroup

_SLOWEST_S = 0.2  # of a force sensor


@dataclass(frozen=True)
class ForceLagParameters(ParameterGroup):
    """Parameters of `ForceLag`."""

    tau: float = optional_parameter('Time constant of the low-pass filter', 's', minimum=0.0)


class ForceLag(ForceSensorEffect):
    """tau y' + y = F."""

    name = 'force_lag'
    equation = "tau y' + y = F_e"
    family = 'timing'
    description = 'The force signal is low-pass filtered.'
    Parameters = ForceLagParameters

    memory = True
    sampled_delay = 'tau'

    def __init__(self, values: ForceLagParameters) -> None:
        super().__init__(values)
        self._y: float | None = None
        self._last = 0.0

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Filter F, interpolated linearly; see `ForceSensorEffect.sense`."""
        decay, begin, end = self.weights(dt)
        y = force if self._y is None else decay * self._y + begin * self._last + end * force
        self._y, self._last = y, force
        return y

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Filter F, interpolated linearly; see `ForceSensorEffect.sense_along`."""
        from scipy.signal import lfilter  # slow to import, and no node needs it

        decay, begin, end = self.weights(float(t[1] - t[0]))
        push = np.concatenate(([force[0]], begin * force[:-1] + end * force[1:]))
        return np.asarray(lfilter([1.0], [1.0, -decay], push))

    def undo_along(self, t: Array, measured: Array) -> Array:
        """Return tau y' + y from central differences; see `ForceSensorEffect.undo_along`."""
        return np.asarray(measured + self.values.tau * np.gradient(measured, t))

    def weights(self, dt: float) -> tuple[float, float, float]:
        """
        Solve the equation over a step: y = decay y_0 + begin F_0 + end F_1.

        dt: the step [s]
        Returns decay, begin, end: weights of the last y and of the forces [1]
        """
        tau = self.values.tau
        if dt <= 0.0 or tau < 1e-3 * dt:
            return 0.0, 0.0, 1.0
        decay = exp(-dt / tau)
        mean = tau / dt * (1.0 - decay)
        return decay, mean - decay, 1.0 - mean

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Return whether a sensor can be so slow; a specimen that relaxes looks the same."""
        return bool(values.tau < _SLOWEST_S)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread tau."""
        return [(tau,) for tau in scales.delays()[::2]]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return 0.1 s."""
        return 0.1
