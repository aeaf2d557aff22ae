# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Hum of the mains on the force."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.random import Generator

from .law import Array, Magnitudes, SensorLaw, Signals, Strength


class MainsHum(SensorLaw):
    """
    Interference at the mains frequency and its harmonics.

    y = F_e + amplitude (sin(omega t) + second sin(2 omega t) + third sin(3 omega t)), each
    with its phase.
    Ott, Electromagnetic Compatibility Engineering, 2009 (grounding).
    """

    stages = ('press', 'specimen', 'drive')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        mains = float(rng.choice([50.0, 60.0])) * float(rng.uniform(0.998, 1.002))
        second, third = float(rng.uniform(0.0, 0.4)), float(rng.uniform(0.1, 0.6))
        phase = float(rng.uniform(0.0, 2.0 * pi))
        return lambda s: {'amplitude': 0.3 * s * magnitudes.force, 'mains': mains,
                          'second': second, 'third': third, 'phase': phase}

    def sense(self, signals: Signals) -> Array:
        """Return the force with hum; see `SensorLaw.sense`."""
        p, angle = self.values, 2.0 * pi * self.values.mains * signals.t + self.values.phase
        hum = np.sin(angle) + p.second * np.sin(2.0 * angle + 1.0) + p.third * np.sin(3.0 * angle)
        return np.asarray(signals.force + p.amplitude * hum)
