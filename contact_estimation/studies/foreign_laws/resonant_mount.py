# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Force sensor on a mount that rings."""

from __future__ import annotations

from math import pi

from numpy.random import Generator

from .law import Array, Magnitudes, SensorLaw, Signals, Strength
from .linear_filter import filtered


class ResonantMount(SensorLaw):
    """
    A lightly damped resonance of sensor and tool between 20 and 60 Hz.

    y = r + mass a, r'' + 2 zeta omega r' + omega^2 r = omega^2 (F_e - mass a): the mass on the
    sensor is known and taken off, its ringing is not.
    Eppinger and Seering, IEEE Control Systems Magazine 7(2), 1987 (sensor dynamics).
    """

    stages = ('press', 'drive')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        frequency, zeta = float(rng.uniform(20.0, 60.0)), float(rng.uniform(0.01, 0.06))
        mass = magnitudes.force * magnitudes.depth / magnitudes.speed**2
        return lambda s: {'mass': s * mass, 'frequency': frequency, 'zeta': zeta}

    def sense(self, signals: Signals) -> Array:
        """Return the ringing force; see `SensorLaw.sense`."""
        p, omega = self.values, 2.0 * pi * self.values.frequency
        dt, load = float(signals.t[1] - signals.t[0]), signals.force - p.mass * signals.a
        ringing = filtered(load, dt, [omega**2], [1.0, 2.0 * p.zeta * omega, omega**2], load[0])
        return ringing + p.mass * signals.a
