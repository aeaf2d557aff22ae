# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Constant offset of the surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ContactOffsetParameters(ParameterGroup):
    """Parameters of `ContactOffset`."""

    offset: float = optional_parameter('Position of the surface relative to the modelled one', 'm')


class ContactOffset(ContactEffect):
    """x_e = nominal + offset."""

    name = 'contact_offset'
    equation = 'x_e = nominal + offset'
    family = 'clearance'
    description = 'The surface is not where the model places it.'
    Parameters = ContactOffsetParameters
    reached_length = 'offset'
    either_sign = True
    needs_spring = True
    needs_touch = True  # in an attached environment it is a bias K_e times as large

    def surface(self, t: Number, state: Any, m: Any) -> tuple[Any, Any]:
        """Return the constant shift; see `ContactEffect.surface`."""
        return self.values.offset, 0.0

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Start with offsets of both signs, and with walls further in."""
        shares = (0.001, -0.001, 0.03, 0.1, 0.3, 0.6, 0.8, 0.95)
        return [(share * scales.depth,) for share in shares]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return half the largest depth."""
        return 0.5 * scales.depth
