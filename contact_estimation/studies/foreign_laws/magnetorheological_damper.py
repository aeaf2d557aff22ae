# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Magnetorheological damper."""

from __future__ import annotations

from math import tanh
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, Strength


class MagnetorheologicalDamper(ContactLaw):
    """
    A yielding fluid, its yield force delayed by the elasticity of damper and gas.

    R = force tanh(v / v_0 + lead tanh(d / x_0)).
    Kwok, Ha, Nguyen, Li and Samali, Sensors and Actuators A 132(2), 2006.
    """

    families = ('friction', 'hysteresis')
    stages = ('specimen', 'drive')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        v_0 = magnitudes.speed * log_uniform(rng, 0.05, 0.3)
        lead, x_0 = float(rng.uniform(0.1, 0.6)), 0.1 * magnitudes.depth
        force = 0.4 * magnitudes.force
        return lambda s: {'force': s * force, 'v_0': v_0, 'lead': lead, 'x_0': x_0}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the force of the fluid; see `ContactLaw.respond`."""
        p = self.values
        return p.force * tanh(v / p.v_0 + p.lead * tanh(d / p.x_0)), None
