# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Flexible joint: the encoder sits on the motor side."""

from __future__ import annotations

from math import sqrt

from numpy.random import Generator

from .law import Compliance, log_uniform, Magnitudes, RobotLaw, Strength


class FlexibleJoint(RobotLaw):
    """
    The link follows the motor through the elasticity of the gear.

    Motor: (M_t - m) x'' = u - k (x - y) - c (x' - y').
    Link: m y'' = k (x - y) + c (x' - y') + F_e.
    Spong, J. Dynamic Systems, Measurement, and Control 109(4), 1987.
    """

    families = ('robot', 'inertia', 'timing', 'relaxation')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        mass = magnitudes.mass * log_uniform(rng, 0.2, 0.5)
        softest = 0.5 / magnitudes.stiffness
        ratio = float(rng.uniform(0.05, 0.3))
        return lambda s: {'mass': mass, 'stiffness': 1.0 / (max(s, 1e-6) * softest),
                          'damping': 2.0 * ratio * sqrt(mass / (max(s, 1e-6) * softest))}

    def compliance(self) -> Compliance:
        """Return link and gear; see `ForeignLaw.compliance`."""
        return Compliance(self.values.mass, self.values.stiffness, self.values.damping)
