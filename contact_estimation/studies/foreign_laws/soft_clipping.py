# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Amplifier that saturates softly."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from .law import Array, Magnitudes, SensorLaw, Signals, Strength


class SoftClipping(SensorLaw):
    """
    A force sensor whose reading bends towards a limit.

    y = limit tanh(F_e / limit).
    Yeh, Abel and Smith, Proc. Digital Audio Effects, 2007 (saturating amplifiers).
    """

    families = ('limits', 'sensor_gain', 'elastic_law')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        force = magnitudes.force
        return lambda s: {'limit': force / (1.5 * max(s, 1e-6))}

    def sense(self, signals: Signals) -> Array:
        """Return the bent force; see `SensorLaw.sense`."""
        return np.asarray(self.values.limit * np.tanh(signals.force / self.values.limit))
