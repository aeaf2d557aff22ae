# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import exp

import numpy as np

from .law import (
    Array, dataclass, ForceSensorEffect, Need, optional_parameter, Prior, Reader, Scales)

_SLOWEST_S = 0.2  # of a force sensor; a specimen that relaxes looks the same


@dataclass(frozen=True)
class ForceLag(ForceSensorEffect):
    """The force signal is low-pass filtered."""

    tau: float = optional_parameter('Time constant of the low-pass filter', 's', minimum=0.0)

    equation = "tau y' + y = F_e"
    family = 'timing'
    needs = frozenset({Need.RETURN})  # of one stroke it is what relaxes, or another surface

    def reader(self) -> Reader:
        """Filter F, interpolated linearly."""
        past: list[tuple[float, float]] = []

        def read(t: float, dt: float, force: float, acceleration: float) -> float:
            decay, begin, end = self.weights(dt)
            y, last = past.pop() if past else (force, force)
            past.append((decay * y + begin * last + end * force, force))
            return past[0][0]

        return read

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        from scipy.signal import lfilter  # slow to import, and no node needs it

        decay, begin, end = self.weights(float(t[1] - t[0]))
        push = np.concatenate(([force[0]], begin * force[:-1] + end * force[1:]))
        return np.asarray(lfilter([1.0], [1.0, -decay], push))

    def undo_along(self, t: Array, measured: Array) -> Array:
        return np.asarray(measured + self.tau * np.gradient(measured, t))

    def weights(self, dt: float) -> tuple[float, float, float]:
        """Return decay, begin, end of a step [s]: y = decay y_0 + begin F_0 + end F_1."""
        if dt <= 0.0 or self.tau < 1e-3 * dt:
            return 0.0, 0.0, 1.0
        decay = exp(-dt / self.tau)
        mean = self.tau / dt * (1.0 - decay)
        return decay, mean - decay, 1.0 - mean

    def is_possible(self, stiffness: float, damping: float) -> bool:
        return self.tau < _SLOWEST_S

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(tau,) for tau in scales.delays()[::2]], largest=0.1)
