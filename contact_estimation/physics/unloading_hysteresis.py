# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Elastic hysteresis: the wall unloads along a steeper line than it loads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Array, Flags, Number, positive, stretches
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class UnloadingHysteresisParameters(ParameterGroup):
    """Parameters of `UnloadingHysteresis`."""

    ratio: float = optional_parameter(
        'Stiffness of unloading less that of loading, over the latter', '1', minimum=0.0,
        maximum=100.0)


class UnloadingHysteresis(ContactEffect):
    """
    d is replaced by max(0, d - ratio (d_max - d)), d_max the greatest d of the contact.

    Below d_max the wall unloads and reloads along a line of the stiffness (1 + ratio) K_e; out of
    contact it recovers. Walton and Braun, J. Rheology 30(5), 1986.
    """

    name = 'unloading_hysteresis'
    equation = 'd replaced by max(0, d - ratio (d_max - d)), d_max the greatest of the contact'
    family = 'hysteresis'
    description = 'The wall unloads along a steeper line than it loads, recovering out of contact.'
    Parameters = UnloadingHysteresisParameters
    needs_return = True
    needs_spring = True
    needs_penetration = True  # pulled as well as pressed, a wall has no side on which it loads

    states = 1  # greatest d of the contact

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        """Return the depth that is left to recover; see `ContactEffect.transmit`."""
        # The greatest depth grows with the tool, also within a step of integration.
        inside = positive(d, m)
        left = positive(inside - self.values.ratio * positive(state[0] - d, m), m)
        return d + (left - inside), v, True

    def settle(
        self, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Store the greatest d; forget it out of contact."""
        return (max(state[0], d) if contact else 0.0,)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Return the running maximum of d in each contact."""
        states = np.zeros((1, len(t)))
        for first, stop in stretches(contact):
            if contact[first]:
                states[0, first:stop] = np.maximum.accumulate(np.maximum(d[first:stop], 0.0))
        return states

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Start with a small and a large difference."""
        return [(0.05,), (0.5,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return 2: a third of the depth is left when the force vanishes."""
        return 2.0
