# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Spring that softens, then hardens, or the reverse."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .contact_effect import ContactEffect
from .drawn_effect import Scales, Strength
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class PolynomialStiffnessParameters(ParameterGroup):
    """Parameters of `PolynomialStiffness`."""

    K_2: float = optional_parameter('Stiffness that grows with the depth', 'N/m^2')
    K_3: float = optional_parameter('Stiffness that grows with its square', 'N/m^3')


class PolynomialStiffness(ContactEffect):
    """
    F_e -= K_2 d |d| + K_3 d^3.

    The shortest series with a plateau: foam buckles (K_2 < 0), then its cells touch (K_3 > 0), see
    Gibson and Ashby, Cellular Solids, 1997.
    """

    name = 'polynomial_stiffness'
    equation = 'F_e -= K_2 d |d| + K_3 d^3'
    family = 'elastic_law'
    description = 'The wall softens and then hardens with depth, or the reverse.'
    Parameters = PolynomialStiffnessParameters

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return K_2 d |d| + K_3 d^3; see `ContactEffect.resistance`."""
        return (self.values.K_2 * abs(d) + self.values.K_3 * d * d) * d

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """Return True: two powers of the depth follow any elastic misfit."""
        return True

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Start near 0 with opposite signs; the law is linear in both."""
        K = 0.01 * scales.spring / scales.depth
        return [(-K, K / scales.depth)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw the depth at which it is as soft as it gets, where some stiffness is left."""
        softest = float(rng.uniform(0.3, 0.6)) * scales.depth
        return lambda s: {'K_2': -0.9 * min(s, 1.0) * scales.stiffness / softest,
                          'K_3': 0.3 * min(s, 1.0) * scales.stiffness / softest**2}
