# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Command that reaches the robot at a lower rate."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from .law import Array, Magnitudes, RobotLaw, Strength


class SampledCommand(RobotLaw):
    """
    The robot holds each command until the next one, which comes late.

    The reference at t is that of delay + period floor((t - delay) / period) - delay.
    Astrom and Wittenmark, Computer-Controlled Systems, 1997 (hold circuits).
    """

    families = ('timing',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        late = float(rng.uniform(0.2, 1.0))
        return lambda s: {'period': 0.1 * s, 'delay': 0.1 * s * late}

    def follow(self, t: Array, reference: Array) -> Array:
        """Return the held reference; see `RobotLaw.follow`."""
        p = self.values
        sent = p.period * np.floor((t - p.delay) / p.period)
        return np.column_stack([np.interp(sent, t, column) for column in reference.T])
