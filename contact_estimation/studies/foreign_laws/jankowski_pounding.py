# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Damping of the approach alone."""

from __future__ import annotations

from math import sqrt
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class JankowskiPounding(ContactLaw):
    """
    Structures that collide lose energy while they approach, and none while they part.

    R = c sqrt(d) v for v > 0, else 0, in place of B_e v.
    Jankowski, Earthquake Engineering and Structural Dynamics 34(6), 2005.
    """

    families = ('damping_law',)
    stages = ('press',)
    keeps_damper = False

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        c = 2.0 * magnitudes.force / (magnitudes.speed * sqrt(magnitudes.depth))
        return lambda s: {'c': s * c}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the damping force; see `ContactLaw.respond`."""
        return self.values.c * sqrt(abs(d)) * max(v, 0.0), None
