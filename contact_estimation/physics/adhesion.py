# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Adhesion between wall and tool."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Array, Flags, Number
from ..parameters.specification import optional_parameter, ParameterGroup

NECK = 1.5e-3
"""Distance from the surface at which adhesion ends [m]."""


@dataclass(frozen=True)
class AdhesionParameters(ParameterGroup):
    """Parameters of `Adhesion`."""

    F_a: float = optional_parameter('Largest pull of the wall', 'N', minimum=0.0)


class Adhesion(ContactEffect):
    """In contact F_e <= F_a; then, withdrawing, F_e = F_a (1 + d / 1.5 mm) until d = -1.5 mm."""

    name = 'adhesion'
    equation = 'F_e <= F_a in contact; F_e = F_a (1 + d / 1.5 mm) on leaving'
    family = 'adhesion'
    description = 'The wall sticks to the tool and pulls it back on withdrawal.'
    Parameters = AdhesionParameters
    needs_touch = True

    states = 1  # 1 from touch-down until the neck has torn

    def __init__(self, values: AdhesionParameters) -> None:
        super().__init__(values)
        self.pull = values.F_a
        self.reach = NECK

    def tail(self, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return the pull of the neck; see `ContactEffect.tail`."""
        holds = (state[0] > 0.5) * (v < 0.0) * (d > -self.reach)
        return holds * self.values.F_a * (1.0 + d / self.reach)

    def settle(
        self, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Stick on contact, tear at the end of the neck."""
        return (1.0,) if contact else (state[0] if d > -self.reach else 0.0,)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Return 1 where contact is more recent than the end of the neck, else 0."""
        index = np.arange(1, len(t) + 1)
        touched = np.maximum.accumulate(np.where(contact, index, 0))
        torn = np.maximum.accumulate(np.where(d <= -self.reach, index, 0))
        return (touched > torn).astype(float)[None, :]

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Start from the greatest pull in the recording."""
        return [(max(scales.greatest_pull, 0.02 * scales.force),)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return 0.7 times the largest force."""
        return 0.7 * scales.force
