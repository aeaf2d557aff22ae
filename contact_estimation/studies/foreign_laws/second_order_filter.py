# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Force sensor behind a filter of second order."""

from __future__ import annotations

from math import pi

from numpy.random import Generator

from .law import Array, Magnitudes, SensorLaw, Signals, Strength
from .linear_filter import filtered


class SecondOrderFilter(SensorLaw):
    """
    A low-pass filter of second order whose delay nobody subtracts.

    y'' + 2 zeta omega y' + omega^2 y = omega^2 F_e.
    Oppenheim and Willsky, Signals and Systems, 1997.
    """

    families = ('timing',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        zeta = float(rng.uniform(0.5, 1.0))
        return lambda s: {'period': 0.5 * s, 'zeta': zeta}

    def sense(self, signals: Signals) -> Array:
        """Return the filtered force; see `SensorLaw.sense`."""
        omega, dt = 2.0 * pi / self.values.period, float(signals.t[1] - signals.t[0])
        denominator = [1.0, 2.0 * self.values.zeta * omega, omega**2]
        return filtered(signals.force, dt, [omega**2], denominator, float(signals.force[0]))
