# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Cubic stiffness of the wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .contact_effect import ContactEffect
from .drawn_effect import Scales, Strength
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class CubicStiffnessParameters(ParameterGroup):
    """Parameters of `CubicStiffness`."""

    K_3: float = optional_parameter(
        'Coefficient of the cubic force; negative: the wall softens with depth', 'N/m^3')


class CubicStiffness(ContactEffect):
    """R = K_3 d^3; negative softens."""

    name = 'cubic_stiffness'
    equation = 'F_e -= K_3 d^3'
    family = 'elastic_law'
    description = 'The stiffness of the wall increases or decreases with the square of the depth.'
    Parameters = CubicStiffnessParameters

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return K_3 d^3; see `ContactEffect.resistance`."""
        return self.values.K_3 * d * d * d

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in K_3."""
        return [(0.002 * scales.spring / scales.depth**2,)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw whether the wall hardens or softens."""
        share = float(rng.choice([1.0, -0.2]))  # a softening wall must not push less when deeper
        return lambda s: {'K_3': s * share * scales.stiffness / scales.depth**2}
