# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Exponential elasticity of soft tissue."""

from __future__ import annotations

from math import copysign, expm1
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class FungElasticity(ContactLaw):
    """
    A spring whose stiffness grows exponentially with the depth.

    R = K (exp(b d) - 1) / b in place of K_e d.
    Fung, American J. Physiology 213(6), 1967.
    """

    families = ('elastic_law',)
    stages = ('press', 'specimen', 'slow')
    keeps_spring = False

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        K, b = magnitudes.stiffness, 2.5 / magnitudes.depth
        return lambda s: {'K': K / (1.0 + s), 'b': max(s, 1e-6) * b}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the elastic force; see `ContactLaw.respond`."""
        p = self.values
        return copysign(p.K * expm1(p.b * abs(d)) / p.b, d), None
