# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    Any, ContactEffect, dataclass, Need, Number, optional_parameter, positive, Prior, Scales)


@dataclass(frozen=True)
class DeadZone(ContactEffect):
    """Within a gap below the surface only the damper acts; the spring starts deeper."""

    gap: float = optional_parameter('Depth at which the spring starts', 'm', minimum=0.0)

    equation = 'F_e = -(K_e max(d - gap, 0) + B_e v)'
    family = 'clearance'
    needs = frozenset({Need.TOUCH})

    def deflection(self, t: Number, d: Number, m: Any) -> Number:
        return positive(d - self.gap, m)

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        shares = (0.003, 0.03, 0.1, 0.3, 0.6, 0.8, 0.95)
        return Prior([(share * scales.depth,) for share in shares], largest=0.5 * scales.depth)
