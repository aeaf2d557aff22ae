# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Joint friction that depends on the position."""

from __future__ import annotations

from math import pi, sin

from numpy.random import Generator

from .law import log_uniform, Magnitudes, RobotLaw, Strength


class JointFriction(RobotLaw):
    """
    Coulomb friction of a gear with a wave of its teeth or of an eccentric seal.

    Friction F_c (1 + wave sin(2 pi x / pitch)) against the motion, reached over a short bend.
    Armstrong-Helouvry, Control of Machines with Friction, 1991 (position dependence).
    """

    families = ('robot',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        F_c = 0.3 * magnitudes.force
        wave = float(rng.uniform(0.2, 0.6))
        pitch = magnitudes.depth * log_uniform(rng, 0.3, 2.0)
        stiffness = F_c / (2e-3 * magnitudes.depth)
        return lambda s: {'F_c': s * F_c, 'wave': wave, 'pitch': pitch,
                          'stiffness': s * stiffness}

    def drive(
        self, u: float, x: float, v: float, dt: float, state: float
    ) -> tuple[float, float]:
        """Return the force less the friction; see `RobotLaw.drive`."""
        p = self.values
        most = p.F_c * (1.0 + p.wave * sin(2.0 * pi * x / p.pitch))
        friction = min(most, max(-most, state + p.stiffness * v * dt))
        return u - friction, friction
