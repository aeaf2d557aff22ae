# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import expm1

from .law import (
    Any, ContactEffect, dataclass, Generator, Number, optional_parameter, positive, Prior, Scales,
    Strength)

_LARGEST = 50.0  # exponent; reached only by searches far from the truth


@dataclass(frozen=True)
class ExponentialStiffness(ContactEffect):
    """The stiffness of the wall rises exponentially with the depth (soft tissue)."""

    A: float = optional_parameter('Scale of the force', 'N', minimum=0.0)
    depth: float = optional_parameter(
        'Depth over which the additional stiffness grows by e', 'm', minimum=1e-12,
        logarithmic=True)

    equation = 'F_e -= A (exp(d / depth) - 1 - d / depth)'
    family = 'elastic_law'

    def elastic(self, d: Number, m: Any) -> Number:
        x = d / self.depth
        beyond = positive(x - _LARGEST, m)  # there the exponential goes on as a straight line
        return self.A * (m.exp(x - beyond) * (1.0 + beyond) - 1.0 - x)

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # With a small A the depth would not matter.
        return Prior([(_scale(0.3, share, scales), share * scales.depth)
                      for share in (0.1, 0.2, 0.4, 1.0)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        share = float(rng.uniform(0.15, 0.5))
        return lambda s: {'A': _scale(s, share, scales), 'depth': share * scales.depth}


def _scale(added: float, share: float, scales: Scales) -> float:
    """Return A that adds a share of the elastic force, for a share of the deepest."""
    return added * scales.spring * scales.depth / (expm1(1.0 / share) - 1.0 / share)
