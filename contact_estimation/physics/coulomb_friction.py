# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, ContactEffect, dataclass, Need, Number, optional_parameter, Prior, Scales


@dataclass(frozen=True)
class CoulombFriction(ContactEffect):
    """Dry friction of constant magnitude opposes the motion of the wall."""

    F_c: float = optional_parameter('Dry friction force of the wall', 'N', minimum=0.0)

    equation = 'F_e -= F_c sgn(v)'
    family = 'friction'
    needs = frozenset({Need.RETURN})
    jumps = True

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        return self.F_c * m.tanh(v / self.sign_velocity)

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.002 * scales.force,)], largest=0.4 * scales.force)
