# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    Any, ContactEffect, dataclass, Need, Number, optional_parameter, positive, Prior, Scales)

LARGEST_DAMPING = 300.0
"""Largest plausible damping at half the depth [N s/m]."""


@dataclass(frozen=True)
class HuntCrossleyDamping(ContactEffect):
    """
    Damping of the wall proportional to depth, without a force step at touch-down.

    chi d^n v together with power_law_stiffness. Hunt and Crossley (1975).
    """

    chi: float = optional_parameter('Damping per unit depth', 'N s/m^2', minimum=0.0)

    equation = 'F_e = -(K_e d + chi d v)'
    family = 'damping_law'
    needs = frozenset({Need.PRESSING})

    def damper(self, d: Number, v: Number, exponent: float, m: Any) -> Number:
        depth = d if exponent == 1.0 else positive(d, m) ** exponent
        return self.chi * depth * v

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(2.0 * scales.damper / scales.depth,)],
                     largest=2.0 * LARGEST_DAMPING / scales.depth)
