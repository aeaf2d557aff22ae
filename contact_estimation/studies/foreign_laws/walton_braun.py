# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Loading and unloading along springs of different stiffness."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class WaltonBraun(ContactLaw):
    """
    A partly plastic contact that unloads along a steeper line.

    R = K d while loading; K_u (d - d_0) while unloading and reloading below the greatest depth,
    but not below 0; in place of K_e d. The depth is forgotten when contact is lost.
    Walton and Braun, J. Rheology 30(5), 1986.
    """

    families = ('hysteresis', 'elastic_law')
    keeps_spring = False

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        K = magnitudes.stiffness
        return lambda s: {'K': K, 'K_u': K * (1.0 + 2.0 * s)}

    def start(self, dt: float, count: int) -> Any:
        """Return the greatest depth so far."""
        return 0.0

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the elastic force; see `ContactLaw.respond`."""
        p, greatest = self.values, max(state, d)
        unloading = p.K * greatest - p.K_u * (greatest - d)
        return min(p.K * d, max(unloading, min(0.0, p.K * d))), greatest

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the depth is forgotten."""
        return 0.0, 0.0
