# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Force sensor whose sensitivity changes as it warms up."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from .law import Array, Magnitudes, SensorLaw, Signals, Strength


class WarmingSensor(SensorLaw):
    """
    A gain that approaches another value exponentially.

    y = F_e (1 + change (1 - exp(-t / tau))).
    Fraden, Handbook of Modern Sensors, 2016 (thermal sensitivity shift). On a specimen it is the
    same as a stiffness that drifts.
    """

    stages = ('press', 'drive')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        tau = magnitudes.duration * float(rng.uniform(0.1, 0.5))
        change = float(rng.choice([-0.6, 0.6]))
        return lambda s: {'change': s * change, 'tau': tau}

    def sense(self, signals: Signals) -> Array:
        """Return the force with its gain; see `SensorLaw.sense`."""
        p = self.values
        return np.asarray(signals.force * (1.0 + p.change * (1.0 - np.exp(-signals.t / p.tau))))
