# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, ContactEffect, dataclass, Number, optional_parameter, Prior, Scales


@dataclass(frozen=True)
class QuadraticDamping(ContactEffect):
    """Drag of the wall proportional to the square of the speed."""

    B_2: float = optional_parameter('Drag at 1 m/s', 'N s^2/m^2')

    equation = 'F_e -= B_2 v |v|'
    family = 'damping_law'

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        return self.B_2 * v * abs(v)

    def is_possible(self, stiffness: float, damping: float) -> bool:
        """Refuse drag that falls with speed: it would drive the motion."""
        return self.B_2 >= 0.0

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.01 * scales.damper / scales.speed,)],
                     largest=0.5 * scales.force / scales.speed**2)
