# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    Any, dataclass, ForceSensorEffect, Need, Number, optional_parameter, Prior, Scales, Seen)


@dataclass(frozen=True)
class ForceDrift(ForceSensorEffect):
    """The zero of the force sensor drifts linearly with time."""

    rate: float = optional_parameter('Rate of change of the measured force without load', 'N/s')

    equation = 'F_measured = F_e + rate t'
    family = 'sensor_zero'
    needs = frozenset({Need.RETURN})  # of one stroke and a hold, time tells what relaxes, too

    def sense(self, t: Number, force: Number, acceleration: Number, m: Any) -> Number:
        return force + self.rate * t

    def undo(self, t: Number, measured: Number) -> Number:
        return measured - self.rate * t

    def is_flexible(self, seen: Seen) -> bool:
        return True

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        rate = scales.force / scales.duration
        return Prior([(0.002 * rate,)], largest=0.5 * rate, either_sign=True)
