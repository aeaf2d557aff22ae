# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

import numpy as np

from .law import (
    Any, Array, ContactEffect, dataclass, Flags, Need, Number, optional_parameter, positive, Prior,
    Scales, State, stretches)

_SLOWEST = 0.25  # touch-down that the law holds for, of the speed at which friction fades


@dataclass(frozen=True)
class ImpactDamping(ContactEffect):
    """
    Damping proportional to depth, weaker after a fast touch-down.

    An impact then loses the same share of its energy at any speed: chi = 3 (1 - e^2) / 4 K_e for
    a coefficient of restitution e. Lankarani and Nikravesh, J. Mechanical Design 112(3), 1990.
    """

    chi: float = optional_parameter(
        'Damping per unit depth, times the speed of the touch-down', 'N/m', minimum=0.0)

    equation = 'F_e -= chi d v / v_0, v_0 the speed at the last touch-down'
    family = 'damping_law'
    needs = frozenset({Need.TOUCH})
    states = 1  # v_0, 0 out of contact

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        slowest = _SLOWEST * self.sign_velocity
        speed = state[0] + (state[0] < slowest) * (slowest - state[0])
        return self.chi * positive(d, m) * v / speed

    def settle(self, d: float, v: float, contact: bool, state: State) -> State:
        return (state[0] or max(abs(v), _SLOWEST * self.sign_velocity) if contact else 0.0,)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        states = np.zeros((1, len(t)))
        for first, stop in stretches(contact):
            if contact[first]:
                states[0, first:stop] = max(abs(float(v[first])), _SLOWEST * self.sign_velocity)
        return states

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # The largest leaves no rebound.
        return Prior([(0.2 * scales.spring,)], largest=0.75 * scales.spring)
