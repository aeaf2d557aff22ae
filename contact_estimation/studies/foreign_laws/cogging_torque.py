# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Drives whose torque has a ripple."""

from __future__ import annotations

from math import pi, sin

from numpy.random import Generator

from .law import Magnitudes, RobotLaw, Strength


class CoggingTorque(RobotLaw):
    """
    A torque that pulls towards the slots of the motor.

    Force amplitude sin(2 pi x / pitch) beside that of the drives.
    Jahns and Soong, IEEE Trans. Industrial Electronics 43(2), 1996 (cogging).
    """

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        pitch = magnitudes.depth / float(rng.uniform(2.0, 5.0))
        return lambda s: {'amplitude': 0.3 * s * magnitudes.force, 'pitch': pitch}

    def drive(
        self, u: float, x: float, v: float, dt: float, state: float
    ) -> tuple[float, float]:
        """Return the force with the ripple; see `RobotLaw.drive`."""
        return u + self.values.amplitude * sin(2.0 * pi * x / self.values.pitch), state
