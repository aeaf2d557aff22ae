# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Dead zone of the spring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Number, positive
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class DeadZoneParameters(ParameterGroup):
    """Parameters of `DeadZone`."""

    gap: float = optional_parameter('Depth at which the spring starts', 'm', minimum=0.0)


class DeadZone(ContactEffect):
    """K_e max(d - gap, 0); damping from d > 0."""

    name = 'dead_zone'
    equation = 'F_e = -(K_e max(d - gap, 0) + B_e v)'
    family = 'clearance'
    description = 'Within a gap below the surface only the damper acts; the spring starts deeper.'
    Parameters = DeadZoneParameters
    needs_touch = True

    def deflection(self, d: Number, m: Any) -> Number:
        """Return max(d - gap, 0); see `ContactEffect.deflection`."""
        return positive(d - self.values.gap, m)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread the gap."""
        return [(share * scales.depth,) for share in (0.003, 0.03, 0.1, 0.3, 0.6, 0.8, 0.95)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return half the largest depth."""
        return 0.5 * scales.depth
