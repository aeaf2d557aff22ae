# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, ContactEffect, dataclass, Need, Number, optional_parameter, Prior, Scales

_PASSIVE = 1.1  # times B_e, with the error of a fit


@dataclass(frozen=True)
class AsymmetricDamping(ContactEffect):
    """
    Damping that differs between the two directions of motion.

    B_e + B_a for v > 0, B_e - B_a for v < 0. A shock absorber damps rebound more than compression
    (Dixon, The Shock Absorber Handbook, 2007); colliding structures damp their approach (Jankowski
    2005). No direction is driven: |B_a| <= B_e.
    """

    B_a: float = optional_parameter(
        'Half the difference of the damping towards larger and smaller x', 'N s/m')

    equation = 'F_e -= B_a |v|'
    family = 'damping_law'
    needs = frozenset({Need.RETURN})

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        return self.B_a * abs(v)

    def is_possible(self, stiffness: float, damping: float) -> bool:
        return abs(self.B_a) <= _PASSIVE * damping

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.01 * scales.damper,)], largest=scales.damping, either_sign=True)
