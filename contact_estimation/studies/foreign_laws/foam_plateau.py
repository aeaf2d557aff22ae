# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Foam: linear, then a plateau, then densification."""

from __future__ import annotations

from math import copysign, tanh
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class FoamPlateau(ContactLaw):
    """
    Elastic buckling of cells limits the force until they touch.

    R = K (yield tanh(d / yield) + densified (d / depth)^n), the share of a linear spring fading.
    Gibson and Ashby, Cellular Solids, 1997; Rusch, J. Applied Polymer Science 13, 1969.
    """

    families = ('elastic_law',)
    keeps_spring = False

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        crush = magnitudes.depth * float(rng.uniform(0.15, 0.35))
        densified = magnitudes.depth * float(rng.uniform(0.3, 0.7))
        n, K, depth = float(rng.integers(4, 9)), magnitudes.stiffness, magnitudes.depth
        return lambda s: {'K': K, 'share': s, 'crush': crush, 'densified': densified, 'n': n,
                          'depth': depth}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the elastic force; see `ContactLaw.respond`."""
        p = self.values
        dense = copysign(p.densified * abs(d / p.depth) ** p.n, d)
        foam = p.crush * tanh(d / p.crush) + dense
        return p.K * ((1.0 - p.share) * d + p.share * foam), None
