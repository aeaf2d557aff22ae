# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A force sensor whose reading is a power of the force."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from .law import Array, Magnitudes, SensorLaw, Signals, Strength


class PowerCharacteristic(SensorLaw):
    """
    A force sensor calibrated at one force, whose reading is a power of the force.

    y = F_e (|F_e| / F_0)^(n - 1).
    Interlink Electronics, FSR Integration Guide, 2010 (resistance of a pressed film).
    On an attached specimen it is the same as a spring that bends: only the motion of a robot,
    which feels the true force, tells the two apart.
    """

    families = ('sensor_gain',)
    stages = ('press',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        change, force = float(rng.choice([-0.4, 0.6])), 0.5 * magnitudes.force
        return lambda s: {'exponent': 1.0 + s * change, 'force': force}

    def sense(self, signals: Signals) -> Array:
        """Return the distorted force; see `SensorLaw.sense`."""
        ratio = np.abs(signals.force) / self.values.force
        return np.sign(signals.force) * self.values.force * ratio ** self.values.exponent
