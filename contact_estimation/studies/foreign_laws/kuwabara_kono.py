# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Viscoelastic spheres: damping with the root of the depth."""

from __future__ import annotations

from math import sqrt
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class KuwabaraKono(ContactLaw):
    """
    Damping proportional to the radius of the contact area.

    R = c sqrt(abs(d)) v in place of B_e v.
    Kuwabara and Kono, Japanese J. Applied Physics 26(8), 1987; Brilliantov et al., Physical
    Review E 53(5), 1996.
    """

    families = ('damping_law',)
    keeps_damper = False

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        c = 2.0 * magnitudes.force / (magnitudes.speed * magnitudes.depth**0.5)
        return lambda s: {'c': s * c}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the damping force; see `ContactLaw.respond`."""
        return self.values.c * sqrt(abs(d)) * v, None
