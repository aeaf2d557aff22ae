# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from collections import deque

import numpy as np

from .law import (
    Array, dataclass, ForceSensorEffect, Need, optional_parameter, Prior, Reader, Scales)

_SLOWEST_S = 0.5  # of a force sensor; a specimen that relaxes looks the same


@dataclass(frozen=True)
class ForceDelay(ForceSensorEffect):
    """The force signal is delayed relative to the motion."""

    delay: float = optional_parameter('Delay of the force', 's', minimum=0.0)

    equation = 'F_measured(t) = F_e(t - delay)'
    family = 'timing'
    needs = frozenset({Need.RETURN})  # of one stroke it is what relaxes, or another surface

    def reader(self) -> Reader:
        """Interpolate past samples linearly."""
        past: deque[tuple[float, float]] = deque()

        def read(t: float, dt: float, force: float, acceleration: float) -> float:
            then = t - self.delay
            past.append((t, force))
            while len(past) > 1 and past[1][0] <= then:
                past.popleft()
            (t_0, f_0), (t_1, f_1) = past[0], past[min(1, len(past) - 1)]
            if then <= t_0 or t_1 <= t_0:
                return f_0
            return f_0 + (f_1 - f_0) * (then - t_0) / (t_1 - t_0)

        return read

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        return np.interp(t - self.delay, t, force)

    def undo_along(self, t: Array, measured: Array) -> Array:
        return np.interp(t + self.delay, t, measured)

    def is_possible(self, stiffness: float, damping: float) -> bool:
        return self.delay < _SLOWEST_S

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(delay,) for delay in scales.delays()], largest=0.1)
