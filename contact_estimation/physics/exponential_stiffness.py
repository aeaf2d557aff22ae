# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Elastic force that rises exponentially with the depth, as in soft tissue (Fung 1967)."""

from __future__ import annotations

from dataclasses import dataclass
from math import expm1
from typing import Any

from numpy.random import Generator

from .contact_effect import ContactEffect
from .drawn_effect import Scales, Strength
from .numeric import Number, positive
from ..parameters.specification import optional_parameter, ParameterGroup

_LARGEST = 50.0  # exponent; reached only by searches far from the truth


@dataclass(frozen=True)
class ExponentialStiffnessParameters(ParameterGroup):
    """Parameters of `ExponentialStiffness`."""

    A: float = optional_parameter('Scale of the force', 'N', minimum=0.0)
    depth: float = optional_parameter(
        'Depth over which the additional stiffness grows by e', 'm', minimum=1e-12)


class ExponentialStiffness(ContactEffect):
    """R = A (exp(d / depth) - 1) - A d / depth: no stiffness is added at d = 0."""

    name = 'exponential_stiffness'
    equation = 'F_e -= A (exp(d / depth) - 1 - d / depth)'
    family = 'elastic_law'
    description = 'The stiffness of the wall rises exponentially with the depth (soft tissue).'
    Parameters = ExponentialStiffnessParameters
    in_logarithm = ('depth',)
    covered_depth = 'depth'

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return A (exp(d / depth) - 1 - d / depth); see `ContactEffect.resistance`."""
        x = d / self.values.depth
        beyond = positive(x - _LARGEST, m)  # there the exponential goes on as a straight line
        return self.values.A * (m.exp(x - beyond) * (1.0 + beyond) - 1.0 - x)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread depth; the law is linear in A, which is large enough for depth to matter."""
        return [cls._values(0.3, share * scales.depth, scales) for share in (0.1, 0.2, 0.4, 1.0)]

    @classmethod
    def _values(cls, share: float, depth: float, scales: Scales) -> tuple[float, float]:
        """Return A and depth that add a share of the elastic force at the largest depth."""
        x = scales.depth / depth
        return share * scales.spring * scales.depth / (expm1(x) - x), depth

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw the depth."""
        depth = float(rng.uniform(0.15, 0.5)) * scales.depth
        return lambda s: dict(zip(('A', 'depth'), cls._values(s, depth, scales)))
