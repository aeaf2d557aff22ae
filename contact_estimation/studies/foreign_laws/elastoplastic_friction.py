# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Elastoplastic friction: purely elastic up to a break-away."""

from __future__ import annotations

from math import pi, sin, sqrt
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, Strength


class ElastoplasticFriction(ContactLaw):
    """
    Bristles that do not creep below their break-away deflection.

    R = sigma_0 z + sigma_1 z', z' = v (1 - alpha(z, v) z / z_ss) with z_ss = F_c / sigma_0; alpha
    is 0 below z_ba, rises as a half sine to 1 at z_ss, and is 0 where v unloads the bristles.
    Dupont, Hayward, Armstrong and Altpeter, IEEE Trans. Automatic Control 47(5), 2002.
    """

    families = ('friction', 'hysteresis')
    stages = ('press', 'specimen', 'drive')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        F_c = 0.3 * magnitudes.force
        z_ss = magnitudes.depth * log_uniform(rng, 1e-3, 1e-2)
        share = float(rng.uniform(0.3, 0.9))
        damping = 0.2 * sqrt(F_c / z_ss * magnitudes.mass)
        return lambda s: {'F_c': s * F_c, 'z_ss': z_ss, 'z_ba': share * z_ss,
                          'sigma_1': s * damping}

    def start(self, dt: float, count: int) -> Any:
        """Return the deflection of the bristles, 0 at first."""
        return 0.0

    def _slipping(self, z: float, v: float) -> float:
        """Return alpha, the plastic share of the motion."""
        p = self.values
        if z * v <= 0.0 or abs(z) <= p.z_ba:
            return 0.0
        if abs(z) >= p.z_ss:
            return 1.0
        middle = 0.5 * (p.z_ss + p.z_ba)
        return 0.5 + 0.5 * sin(pi * (abs(z) - middle) / (p.z_ss - p.z_ba))

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the friction; see `ContactLaw.respond`."""
        p = self.values
        z = state + dt * v * (1.0 - self._slipping(state, v) * abs(state) / p.z_ss)
        z = min(p.z_ss, max(-p.z_ss, z))
        return p.F_c / p.z_ss * z + p.sigma_1 * (z - state) / dt, z

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the bristles straighten."""
        return 0.0, 0.0
