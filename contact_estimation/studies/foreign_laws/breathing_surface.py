# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Surface that breathes."""

from __future__ import annotations

from math import cos, pi, sin

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, Strength


class BreathingSurface(ContactLaw):
    """
    The surface rests at one end of its motion, as that of a patient who breathes.

    x_e = amplitude cos^(2 n)(pi frequency t + phase).
    Lujan, Larsen, Balter and Ten Haken, Medical Physics 26(5), 1999.
    """

    families = ('wall_motion',)
    stages = ('press',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        frequency, power = log_uniform(rng, 0.3, 3.0), int(rng.integers(1, 4))
        phase, way = float(rng.uniform(0.0, pi)), float(rng.choice([-1.0, 1.0]))
        return lambda s: {'amplitude': 0.3 * way * s * magnitudes.depth, 'frequency': frequency,
                          'power': 2 * power, 'phase': phase}

    def surface(self, t: float) -> tuple[float, float]:
        """Return the motion of the surface; see `ContactLaw.surface`."""
        p = self.values
        angle, power = pi * p.frequency * t + p.phase, int(p.power)
        c, s = cos(angle), sin(angle)
        return (p.amplitude * c**power,
                -p.amplitude * pi * p.frequency * power * c ** (power - 1) * s)
