# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Coulomb friction of different size each way."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, Strength


class AsymmetricCoulomb(ContactLaw):
    """
    Coulomb friction F_in going in and F_out going out, reached over a short elastic bend.

    R' = stiffness v within -F_out <= R <= F_in.
    Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica 30(7), 1994.
    """

    families = ('friction',)
    stages = ('press', 'specimen', 'drive')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        F_in = 0.3 * magnitudes.force
        ratio = float(rng.choice([log_uniform(rng, 0.5, 0.8), log_uniform(rng, 1.25, 2.0)]))
        stiffness = F_in / (magnitudes.depth * log_uniform(rng, 1e-3, 5e-3))
        return lambda s: {'F_in': s * F_in, 'F_out': s * ratio * F_in,
                          'stiffness': s * stiffness}

    def start(self, dt: float, count: int) -> Any:
        """Return the friction at first, 0."""
        return 0.0

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the friction; see `ContactLaw.respond`."""
        p = self.values
        force = min(p.F_in, max(-p.F_out, state + p.stiffness * v * dt))
        return force, force

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the bend recovers."""
        return 0.0, 0.0
