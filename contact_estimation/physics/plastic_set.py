# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Plastic set of the wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Array, Flags, Number, positive
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class PlasticSetParameters(ParameterGroup):
    """Parameters of `PlasticSet`."""

    residual: float = optional_parameter(
        'Fraction of the deepest indentation that remains', '1', minimum=0.0, maximum=0.999)


class PlasticSet(ContactEffect):
    """x_e = nominal + residual (greatest d so far), 0 <= residual < 1."""

    name = 'plastic_set'
    equation = 'x_e = nominal + residual (greatest d so far)'
    family = 'hysteresis'
    description = 'The wall deforms plastically: part of the deepest indentation remains.'
    Parameters = PlasticSetParameters
    needs_return = True
    needs_penetration = True

    states = 1  # greatest d so far, from the untouched surface

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        """Return the depth in the dent that stays; see `ContactEffect.transmit`."""
        # The dent deepens with the tool, also within a step of integration.
        deepest = state[0] + positive(d - state[0], m)
        return d - self.values.residual * deepest, v, True

    def settle(
        self, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Store the largest d, counted from the untouched surface."""
        return (max(state[0], d),)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Return the running maximum of d, from the untouched surface."""
        return np.maximum.accumulate(np.maximum(d, 0.0))[None, :]

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Start with a small and a large residual."""
        return [(0.002,), (0.03,), (0.3,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return 0.9."""
        return 0.9
