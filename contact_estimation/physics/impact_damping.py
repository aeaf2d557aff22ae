# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Damping that is the weaker, the faster the touch-down."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Array, Flags, Number, positive, stretches
from ..parameters.specification import optional_parameter, ParameterGroup

_SLOWEST = 1e-4  # touch-down that the law holds for [m/s]


@dataclass(frozen=True)
class ImpactDampingParameters(ParameterGroup):
    """Parameters of `ImpactDamping`."""

    chi: float = optional_parameter(
        'Damping per unit depth, times the speed of the touch-down', 'N/m', minimum=0.0)


class ImpactDamping(ContactEffect):
    """
    R = chi d v / v_0, v_0 the speed at the last touch-down.

    An impact then loses the same share of its energy at any speed: chi = 3 (1 - e^2) / 4 K_e for
    a coefficient of restitution e. Lankarani and Nikravesh, J. Mechanical Design 112(3), 1990.
    """

    name = 'impact_damping'
    equation = 'F_e -= chi d v / v_0, v_0 the speed at the last touch-down'
    family = 'damping_law'
    description = 'Damping proportional to depth, weaker after a fast touch-down.'
    Parameters = ImpactDampingParameters
    needs_touch = True

    states = 1  # v_0, 0 out of contact

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return chi d v / v_0; see `ContactEffect.resistance`."""
        speed = state[0] + (state[0] < _SLOWEST) * (_SLOWEST - state[0])
        return self.values.chi * positive(d, m) * v / speed

    def settle(
        self, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Store the speed of the touch-down; forget it out of contact."""
        return (state[0] or max(abs(v), _SLOWEST) if contact else 0.0,)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Return the speed at the first sample of each contact."""
        states = np.zeros((1, len(t)))
        for first, stop in stretches(contact):
            if contact[first]:
                states[0, first:stop] = max(abs(float(v[first])), _SLOWEST)
        return states

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in chi."""
        return [(0.2 * scales.spring,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return 3 K_e / 4: without any rebound."""
        return 0.75 * scales.spring
