# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Stiffness periodic in the position."""

from __future__ import annotations

from math import pi, sin
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class StiffnessRipple(ContactLaw):
    """
    A layered or perforated wall.

    R = K_r d sin(2 pi d / wavelength).
    Nayfeh and Mook, Nonlinear Oscillations, 1979 (parametric stiffness).
    """

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        wavelength = magnitudes.depth / float(rng.uniform(2.0, 5.0))
        return lambda s: {'stiffness': 0.5 * s * magnitudes.stiffness, 'wavelength': wavelength}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the periodic part of the spring; see `ContactLaw.respond`."""
        p = self.values
        return p.stiffness * d * sin(2.0 * pi * d / p.wavelength), None
