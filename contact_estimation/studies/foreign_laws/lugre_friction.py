# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""LuGre friction: bristles that bend before they slip."""

from __future__ import annotations

from math import exp, sqrt
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, sign, Strength


class LuGreFriction(ContactLaw):
    """
    Friction of bristles with Stribeck's curve.

    R = sigma_0 z + sigma_1 z', z' = v - sigma_0 abs(v) z / g(v),
    g(v) = F_c + (F_s - F_c) exp(-(v / v_s)^2).
    Canudas de Wit, Olsson, Astrom and Lischinsky, IEEE Trans. Automatic Control 40(3), 1995. The
    law of Bouc and Wen contains that of Dahl, which this one extends.
    """

    families = ('friction', 'hysteresis')
    stages = ('press', 'specimen', 'drive')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        F_c = 0.3 * magnitudes.force
        ratio = float(rng.uniform(1.05, 1.8))
        v_s = magnitudes.speed * log_uniform(rng, 0.02, 0.2)
        bend = magnitudes.depth * log_uniform(rng, 1e-3, 1e-2)
        sigma_0 = F_c / bend
        sigma_1 = 0.2 * sqrt(sigma_0 * magnitudes.mass)
        return lambda s: {'F_c': s * F_c, 'F_s': s * ratio * F_c, 'v_s': v_s,
                          'sigma_0': s * sigma_0, 'sigma_1': s * sigma_1}

    def start(self, dt: float, count: int) -> Any:
        """Return the deflection of the bristles, 0 at first."""
        return 0.0

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the friction; the bristles are solved exactly for constant v."""
        p = self.values
        g = p.F_c + (p.F_s - p.F_c) * exp(-(v / p.v_s) ** 2)
        slid = exp(-p.sigma_0 * abs(v) * dt / g)
        z = slid * state + (1.0 - slid) * g * sign(v) / p.sigma_0
        return p.sigma_0 * z + p.sigma_1 * (z - state) / dt, z

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the bristles straighten."""
        return 0.0, 0.0
