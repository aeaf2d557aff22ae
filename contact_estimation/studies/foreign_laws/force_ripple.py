# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Force periodic in the depth, as of a thread or of magnets."""

from __future__ import annotations

from math import pi, sin
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class ForceRipple(ContactLaw):
    """
    Cogging: a force that neither grows nor fades with the depth.

    R = amplitude sin(2 pi d / wavelength).
    Jahns and Soong, IEEE Trans. Industrial Electronics 43(2), 1996 (cogging).
    """

    stages = ('press', 'specimen', 'drive')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        wavelength = magnitudes.depth / float(rng.uniform(2.0, 5.0))
        return lambda s: {'amplitude': 0.3 * s * magnitudes.force, 'wavelength': wavelength}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the periodic force; see `ContactLaw.respond`."""
        return self.values.amplitude * sin(2.0 * pi * d / self.values.wavelength), None
