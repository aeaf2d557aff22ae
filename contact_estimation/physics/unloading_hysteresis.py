# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

import numpy as np

from .law import (
    Any, Array, ContactEffect, dataclass, Flags, Need, Number, optional_parameter, positive, Prior,
    Scales, State, stretches)


@dataclass(frozen=True)
class UnloadingHysteresis(ContactEffect):
    """
    The wall unloads along a steeper line than it loads, recovering out of contact.

    Below d_max the wall unloads and reloads along a line of the stiffness (1 + ratio) K_e; out of
    contact it recovers. Walton and Braun, J. Rheology 30(5), 1986.
    """

    ratio: float = optional_parameter(
        'Stiffness of unloading less that of loading, over the latter', '1', minimum=0.0,
        maximum=100.0)

    equation = 'd replaced by max(0, d - ratio (d_max - d)), d_max the greatest of the contact'
    family = 'hysteresis'
    # Pulled as well as pressed, a wall has no side on which it loads.
    needs = frozenset({Need.RETURN, Need.SPRING, Need.PRESSING})
    states = 1  # greatest d of the contact

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        # The greatest depth grows with the tool, also within a step of integration.
        inside = positive(d, m)
        left = positive(inside - self.ratio * positive(state[0] - d, m), m)
        return d + (left - inside), v, True

    def settle(self, d: float, v: float, contact: bool, state: State) -> State:
        return (max(state[0], d) if contact else 0.0,)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        states = np.zeros((1, len(t)))
        for first, stop in stretches(contact):
            if contact[first]:
                states[0, first:stop] = np.maximum.accumulate(np.maximum(d[first:stop], 0.0))
        return states

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # With the largest a third of the depth is left when the force vanishes.
        return Prior([(0.05,), (0.5,)], largest=2.0)
