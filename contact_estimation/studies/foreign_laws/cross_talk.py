# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Force that depends on the motion of another axis."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.random import Generator

from .law import Array, Magnitudes, SensorLaw, Signals, Strength


class CrossTalk(SensorLaw):
    """
    Another axis moves by random sines, unrecorded, and loads the sensor sideways.

    y = F_e + gain (sum of 6 sines between 0.1 and 2 Hz, random in phase).
    Siciliano and Khatib, Springer Handbook of Robotics, 2016 (multi-axis force sensors).
    """

    stages = ('press', 'specimen', 'drive')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        seed = float(rng.integers(1_000_000))
        return lambda s: {'gain': 0.2 * s * magnitudes.force, 'seed': seed}

    def sense(self, signals: Signals) -> Array:
        """Return the force with cross-talk; see `SensorLaw.sense`."""
        rng = np.random.default_rng(int(self.values.seed))
        other = sum(np.sin(2.0 * pi * f * signals.t + phase) for f, phase in
                    zip(rng.uniform(0.1, 2.0, 6), rng.uniform(0.0, 2.0 * pi, 6)))
        return np.asarray(signals.force + self.values.gain / 3.0**0.5 * other)
