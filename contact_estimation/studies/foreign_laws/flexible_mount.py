# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Flexible tool mount: a spring in front of the force sensor."""

from __future__ import annotations

from math import sqrt

from numpy.random import Generator

from .law import Array, Compliance, log_uniform, Magnitudes, SensorLaw, Signals, Strength


class FlexibleMount(SensorLaw):
    """
    Sensor and tip sit on a spring; the position is measured before it.

    m y'' = k (x - y) + c (x' - y') + F_e(y, y'), F_e measured at the tip.
    Eppinger and Seering, IEEE Control Systems Magazine 7(2), 1987 (tool compliance).
    """

    families = ('timing', 'relaxation', 'inertia')
    stages = ('press',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        mass = magnitudes.mass * log_uniform(rng, 0.02, 0.1)
        softest = 0.5 / magnitudes.stiffness
        ratio = float(rng.uniform(0.05, 0.3))
        return lambda s: {'mass': mass, 'stiffness': 1.0 / (max(s, 1e-6) * softest),
                          'damping': 2.0 * ratio * sqrt(mass / (max(s, 1e-6) * softest))}

    def compliance(self) -> Compliance:
        """Return the mount; see `ForeignLaw.compliance`."""
        return Compliance(self.values.mass, self.values.stiffness, self.values.damping)

    def sense(self, signals: Signals) -> Array:
        """Return the force at the tip; see `SensorLaw.sense`."""
        return signals.force
