# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Tool with a soft mass between sensor and tip."""

from __future__ import annotations

from math import pi

from numpy.random import Generator

from .law import Array, log_uniform, Magnitudes, SensorLaw, Signals, Strength
from .linear_filter import filtered


class SoftTool(SensorLaw):
    """
    The sensor feels a mass that follows the tool with a lag.

    y = F_e - mass (acceleration low-passed at `corner`).
    Garcia, Robertsson, Ortega and Johansson, IEEE Trans. Robotics 24(2), 2008 (tool inertia).
    """

    families = ('inertia',)
    stages = ('press', 'specimen')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        corner = log_uniform(rng, 15.0, 60.0)
        mass = 0.3 * magnitudes.force * magnitudes.depth / magnitudes.speed**2
        return lambda s: {'mass': s * mass, 'corner': corner}

    def sense(self, signals: Signals) -> Array:
        """Return the force with the inertia of the mass; see `SensorLaw.sense`."""
        dt, omega = float(signals.t[1] - signals.t[0]), 2.0 * pi * self.values.corner
        felt = filtered(signals.a, dt, [omega**2], [1.0, 1.4 * omega, omega**2])
        return signals.force - self.values.mass * felt
