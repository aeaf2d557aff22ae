# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Damper whose force grows with a root of the speed."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class PowerLawDamper(ContactLaw):
    """
    A fluid viscous damper with shear-thinning orifice flow.

    R = c sgn(v) abs(v)^p, 0 < p < 1, in place of B_e v; linear below `slow`.
    Constantinou and Symans, Structural Design of Tall Buildings 2(2), 1993; Lin and Chopra,
    Earthquake Engineering and Structural Dynamics 31, 2002.
    """

    families = ('damping_law', 'friction')
    stages = ('press', 'specimen', 'drive')
    keeps_damper = False

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        p = float(rng.uniform(0.3, 0.6))
        slow, c = 0.02 * magnitudes.speed, magnitudes.force / magnitudes.speed**p
        return lambda s: {'c': s * c, 'p': p, 'slow': slow}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the damping force; see `ContactLaw.respond`."""
        p = self.values
        return p.c * v * (v * v + p.slow * p.slow) ** (0.5 * (p.p - 1.0)), None
