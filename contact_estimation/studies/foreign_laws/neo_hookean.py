# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rubber block under compression."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class NeoHookean(ContactLaw):
    """
    A block of incompressible rubber of height L without friction at its ends.

    R = K L (lambda^-2 - lambda) / 3 in place of K_e d, lambda = 1 - d / L.
    Treloar, The Physics of Rubber Elasticity, 1975.
    """

    families = ('elastic_law',)
    keeps_spring = False

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        K, depth = magnitudes.stiffness, magnitudes.depth
        return lambda s: {'K': K / (1.0 + s), 'height': depth / (0.55 * max(s, 1e-6))}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the elastic force; see `ContactLaw.respond`."""
        p = self.values
        stretch = max(0.1, 1.0 - d / p.height)
        return p.K * p.height / 3.0 * (stretch**-2 - stretch), None
