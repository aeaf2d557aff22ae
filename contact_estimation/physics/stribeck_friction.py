# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, ContactEffect, dataclass, Need, Number, optional_parameter, Prior, Scales

_LEAST_LEFT = 0.1  # of F_s, at speed


@dataclass(frozen=True)
class StribeckFriction(ContactEffect):
    """Dry friction of the wall that decreases with speed (Stribeck effect)."""

    F_c: float = optional_parameter('Friction force at high speed', 'N', minimum=0.0)
    F_s: float = optional_parameter(
        'Friction force near zero speed', 'N', minimum=0.0, linear=True)
    v_s: float = optional_parameter(
        'Stribeck velocity: speed at which F_s - F_c has fallen to 1/e', 'm/s', minimum=1e-15)

    equation = 'F_e -= (F_c + (F_s - F_c) exp(-(v / v_s)^2)) sgn(v)'
    family = 'friction'
    needs = frozenset({Need.RETURN})
    jumps = True

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        level = self.F_c + (self.F_s - self.F_c) * m.exp(-((v / self.v_s) ** 2))
        return level * m.tanh(v / self.sign_velocity)

    def is_possible(self, stiffness: float, damping: float) -> bool:
        """Return whether friction falls with speed, not to nothing, nor where it fades itself."""
        falls = _LEAST_LEFT * self.F_s < self.F_c < self.F_s
        return falls and self.v_s > self.sign_velocity

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.002 * scales.force, 0.004 * scales.force, share * scales.speed)
                      for share in (0.02, 0.05, 0.1, 0.2, 0.4)], largest=0.15 * scales.force)
