# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    Any, ContactEffect, dataclass, Need, Number, optional_parameter, Prior, Scales, Seen)


@dataclass(frozen=True)
class StiffnessDrift(ContactEffect):
    """The stiffness of the wall increases or decreases linearly with time."""

    rate: float = optional_parameter('Relative change of the stiffness per second', '1/s')

    equation = 'F_e = -(K_e (1 + rate t) d + B_e v)'
    family = 'wall_motion'
    # Of one stroke and a hold, time tells what relaxes, too.
    needs = frozenset({Need.RETURN, Need.SPRING})

    def deflection(self, t: Number, d: Number, m: Any) -> Number:
        return d * (1.0 + self.rate * t)

    def is_flexible(self, seen: Seen) -> bool:
        return True

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.002 / scales.duration,)], largest=0.7 / scales.duration, either_sign=True)
