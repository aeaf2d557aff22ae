# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

import numpy as np

from .law import (
    Any, dataclass, ForceSensorEffect, Need, Number, optional_parameter, Prior, Scales, Seen)

_LONGEST = 2.0  # time constant, in the duration of the recording


@dataclass(frozen=True)
class SettlingBias(ForceSensorEffect):
    """The zero of the force sensor settles exponentially, as after switching on."""

    change: float = optional_parameter('Bias at the first sample less that in the end', 'N')
    tau: float = optional_parameter('Time constant of the settling', 's', minimum=0.001)
    bias: float = optional_parameter('Bias in the end', 'N', linear=True)

    equation = 'F_measured = F_e + bias + change exp(-t / tau)'
    family = 'sensor_zero'
    needs = frozenset({Need.RETURN})

    def sense(self, t: Number, force: Number, acceleration: Number, m: Any) -> Number:
        return force + self.bias + self.change * m.exp(-t / self.tau)

    def undo(self, t: Number, measured: Number) -> Number:
        return measured - self.bias - self.change * np.exp(-t / self.tau)

    def is_flexible(self, seen: Seen) -> bool:
        return True

    def may_show(self, seen: Seen) -> bool:
        """Need a bend: what settles much more slowly than the recording ends drifts."""
        return self.tau <= _LONGEST * seen.duration

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.02 * scales.force, share * scales.duration, 0.0)
                      for share in (0.1, 0.25, 0.6)], largest=0.5 * scales.force, either_sign=True)
