# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Load cell that creeps under load."""

from __future__ import annotations

from numpy.random import Generator

from .law import Array, log_uniform, Magnitudes, SensorLaw, Signals, Strength
from .linear_filter import filtered


class LoadCellCreep(SensorLaw):
    """
    A share of the force appears slowly, as of a creeping glue of strain gauges.

    y = F_e + share (F_e low-passed by 1 / (tau s + 1)).
    Bartel and Yaniv, J. Research of the National Bureau of Standards 102(3), 1997.
    """

    families = ('relaxation',)
    stages = ('press', 'specimen', 'slow')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        tau = magnitudes.duration * log_uniform(rng, 0.02, 0.1)
        way = float(rng.choice([-0.4, 0.4]))
        return lambda s: {'share': s * way, 'tau': tau}

    def sense(self, signals: Signals) -> Array:
        """Return the force with its creep; see `SensorLaw.sense`."""
        p, dt = self.values, float(signals.t[1] - signals.t[0])
        return signals.force + p.share * filtered(signals.force, dt, [1.0], [p.tau, 1.0])
