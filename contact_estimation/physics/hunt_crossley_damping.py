# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Hunt-Crossley damping of the wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .contact_effect import ContactEffect
from .drawn_effect import Scales, Values
from .numeric import Number, positive
from ..parameters.specification import optional_parameter, ParameterGroup

LARGEST_DAMPING = 300.0
"""Largest plausible damping at half the depth [N s/m]."""


@dataclass(frozen=True)
class HuntCrossleyDampingParameters(ParameterGroup):
    """Parameters of `HuntCrossleyDamping`."""

    chi: float = optional_parameter('Damping per unit depth', 'N s/m^2', minimum=0.0)


class HuntCrossleyDamping(ContactEffect):
    """
    chi d v in place of B_e v; chi d^n v together with power_law_stiffness.

    Hunt and Crossley (1975).
    """

    name = 'hunt_crossley_damping'
    equation = 'F_e = -(K_e d + chi d v)'
    family = 'damping_law'
    description = 'Damping of the wall proportional to depth, without a force step at touch-down.'
    Parameters = HuntCrossleyDampingParameters
    needs_penetration = True

    replaces_damping = True

    def damper(self, d: Number, v: Number, force: Number, exponent: float, m: Any) -> Number:
        """Return chi d^n v; see `ContactEffect.damper`."""
        depth = d if exponent == 1.0 else positive(d, m) ** exponent
        return self.values.chi * depth * v

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in chi."""
        return [(2.0 * scales.damper / scales.depth,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return chi that corresponds to LARGEST_DAMPING at half the depth."""
        return 2.0 * LARGEST_DAMPING / scales.depth

    @classmethod
    def equivalent_damping(cls, values: Values, damping: float, depth: float) -> float:
        """Return the damping at half the depth: the law has no B_e."""
        return 0.5 * values['chi'] * depth
