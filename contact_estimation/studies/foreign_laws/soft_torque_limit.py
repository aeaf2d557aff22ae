# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Drives that weaken towards their limit."""

from __future__ import annotations

from numpy.random import Generator

from .law import Magnitudes, RobotLaw, Strength


class SoftTorqueLimit(RobotLaw):
    """
    A magnetic circuit that saturates gradually.

    f = u / (1 + abs(u / limit)^4)^(1/4).
    Krause, Wasynczuk and Sudhoff, Analysis of Electric Machinery, 2002 (saturation).
    """

    families = ('limits', 'robot')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        control = magnitudes.control
        return lambda s: {'limit': control / (1.5 * max(s, 1e-6))}

    def drive(
        self, u: float, x: float, v: float, dt: float, state: float
    ) -> tuple[float, float]:
        """Return the weakened force; see `RobotLaw.drive`."""
        return u / (1.0 + (u / self.values.limit) ** 4) ** 0.25, state
