# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Robot with drag proportional to the square of its speed."""

from __future__ import annotations

from numpy.random import Generator

from .law import Magnitudes, RobotLaw, Strength


class Windage(RobotLaw):
    """
    Aerodynamic or churning drag.

    Drag c v abs(v).
    Batchelor, An Introduction to Fluid Dynamics, 1967.
    """

    families = ('robot',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        c = 2.0 * magnitudes.control / magnitudes.speed**2
        return lambda s: {'c': s * c}

    def drive(
        self, u: float, x: float, v: float, dt: float, state: float
    ) -> tuple[float, float]:
        """Return the force less the drag; see `RobotLaw.drive`."""
        return u - self.values.c * v * abs(v), state
