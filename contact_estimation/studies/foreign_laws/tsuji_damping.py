# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Damping with the fourth root of the depth."""

from __future__ import annotations

from math import sqrt
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class TsujiDamping(ContactLaw):
    """
    Damping of colliding spheres with a constant coefficient of restitution.

    R = c abs(d)^(1/4) v in place of B_e v.
    Tsuji, Tanaka and Ishida, Powder Technology 71(3), 1992.
    """

    families = ('damping_law',)
    keeps_damper = False

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        c = 2.0 * magnitudes.force / (magnitudes.speed * magnitudes.depth**0.25)
        return lambda s: {'c': s * c}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the damping force; see `ContactLaw.respond`."""
        return self.values.c * sqrt(sqrt(abs(d))) * v, None
