# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Elastic force that follows a power of the depth (Hertz: 3/2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .contact_effect import ContactEffect
from .drawn_effect import Scales, Strength, Values
from .numeric import Number, positive
from ..parameters.specification import optional_parameter, ParameterGroup

_LEAST_POWER = 0.3


@dataclass(frozen=True)
class PowerLawStiffnessParameters(ParameterGroup):
    """Parameters of `PowerLawStiffness`."""

    n: float = optional_parameter('Exponent of the depth', '1', minimum=0.1, maximum=10.0)
    K_n: float = optional_parameter('Force at 1 m depth', 'N/m^n', minimum=0.0)


class PowerLawStiffness(ContactEffect):
    """K_n d^n in place of K_e d."""

    name = 'power_law_stiffness'
    equation = 'F_e = -(K_n d^n + B_e v)'
    family = 'elastic_law'
    description = 'The elastic force follows a power of the depth (Hertzian contact: 3/2).'
    Parameters = PowerLawStiffnessParameters
    needs_penetration = True
    neutral = {'n': 1.0}
    in_logarithm = ('K_n',)

    replaces_stiffness = True

    def __init__(self, values: PowerLawStiffnessParameters) -> None:
        super().__init__(values)
        self.exponent = values.n

    def spring(self, t: Number, d: Number, force: Number, m: Any) -> Number:
        """Return K_n d^n; see `ContactEffect.spring`."""
        return self.values.K_n * positive(d, m) ** self.values.n

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Return whether the force grows with the depth: of a lesser power it is a step."""
        return bool(values.n >= _LEAST_POWER)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread the exponent, with the force at half the depth unchanged."""
        half, K = 0.5 * scales.depth, scales.spring
        return [(n, K * half ** (1.0 - n)) for n in (0.8, 0.95, 1.0, 1.05, 1.2, 1.5)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw whether the exponent rises or falls; the force at half the depth stays the same."""
        most, half = float(rng.choice([1.0, -0.4])), 0.5 * scales.depth

        def values(s: float) -> Values:
            n = 1.0 + s * most
            return {'n': n, 'K_n': scales.stiffness * half ** (1.0 - n)}

        return values
