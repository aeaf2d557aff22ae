# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Damping of the wall that follows a power of the depth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .contact_effect import ContactEffect
from .drawn_effect import Scales, Strength, Values
from .hunt_crossley_damping import LARGEST_DAMPING
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class PowerLawDampingParameters(ParameterGroup):
    """Parameters of `PowerLawDamping`."""

    B_m: float = optional_parameter('Damping at 1 m depth', 'N s/m/m^m', minimum=0.0)
    m: float = optional_parameter('Exponent of the depth', '1', minimum=0.0, maximum=4.0)


class PowerLawDamping(ContactEffect):
    """
    B_m abs(d)^m v in place of B_e v.

    m = 1/4: Tsuji, Tanaka and Ishida (1992); 1/2: Kuwabara and Kono (1987); 1: Hunt and Crossley
    (1975), which has a name of its own.
    """

    name = 'power_law_damping'
    equation = 'F_e = -(K_e d + B_m abs(d)^m v)'
    family = 'damping_law'
    description = 'The damping of the wall follows a power of the depth (spheres: 1/4 to 3/2).'
    Parameters = PowerLawDampingParameters
    neutral = {'m': 0.0}
    in_logarithm = ('B_m',)

    replaces_damping = True

    def damper(self, d: Number, v: Number, force: Number, exponent: float, m: Any) -> Number:
        """Return B_m abs(d)^m v; see `ContactEffect.damper`."""
        return self.values.B_m * abs(d) ** self.values.m * v

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread the exponent, with the damping at half the depth unchanged."""
        half = 0.5 * scales.depth
        return [(scales.damper / half**m, m) for m in (0.25, 0.5, 1.0, 1.5)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw the exponent."""
        m, half = float(rng.choice([0.25, 0.5, 1.5])), 0.5 * scales.depth
        return lambda s: {'B_m': s * LARGEST_DAMPING / half**m, 'm': m}

    @classmethod
    def equivalent_damping(cls, values: Values, damping: float, depth: float) -> float:
        """Return the damping at half the depth: the law has no B_e."""
        return values['B_m'] * (0.5 * depth) ** values['m']
