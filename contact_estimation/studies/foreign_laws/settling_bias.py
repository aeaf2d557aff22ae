# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Force sensor whose zero settles after switching on."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from .law import Array, log_uniform, Magnitudes, SensorLaw, Signals, Strength


class SettlingBias(SensorLaw):
    """
    A bias that approaches a constant exponentially.

    y = F_e + bias + warm exp(-t / tau).
    Fraden, Handbook of Modern Sensors, 2016 (warm-up time).
    """

    families = ('sensor_zero',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        tau = magnitudes.duration * log_uniform(rng, 0.1, 0.6)
        warm = magnitudes.force * float(rng.choice([-0.5, 0.5]))
        ratio = float(rng.uniform(-0.8, 0.8))
        return lambda s: {'bias': s * ratio * warm, 'warm': s * warm, 'tau': tau}

    def sense(self, signals: Signals) -> Array:
        """Return the force with its bias; see `SensorLaw.sense`."""
        p = self.values
        return signals.force + p.bias + p.warm * np.exp(-signals.t / p.tau)
