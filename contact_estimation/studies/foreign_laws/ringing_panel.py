# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Panel that rings in two modes."""

from __future__ import annotations

from math import pi
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, Strength


class RingingPanel(ContactLaw):
    """
    The masses of two modes, each on its spring and damper behind the surface.

    R = sum of m (omega^2 (d - y) + 2 zeta omega (v - y')) = sum of m y''.
    Ewins, Modal Testing, 2000 (residual flexibility and modal masses).
    """

    families = ('inertia',)
    stages = ('press',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        first, zeta = log_uniform(rng, 6.0, 25.0), log_uniform(rng, 0.03, 0.15)
        ratio, share = float(rng.uniform(1.4, 3.0)), float(rng.uniform(0.2, 0.8))
        return lambda s: {'mass': 0.3 * s * magnitudes.mass, 'share': share, 'frequency': first,
                          'ratio': ratio, 'damping_ratio': zeta}

    def start(self, dt: float, count: int) -> Any:
        """Return displacement and velocity of both masses, 0 at first."""
        return (0.0, 0.0), (0.0, 0.0)

    def _move(self, d: float, v: float, dt: float, state: Any) -> tuple[float, Any]:
        p, force, moved = self.values, 0.0, []
        modes = (1.0 - p.share, p.frequency), (p.share, p.ratio * p.frequency)
        for (part, frequency), (y, w) in zip(modes, state):
            omega = 2.0 * pi * frequency
            y += 0.5 * dt * w
            pull = omega * (omega * (d - y) + 2.0 * p.damping_ratio * (v - w))
            w += dt * pull
            force += part * p.mass * pull
            moved.append((y + 0.5 * dt * w, w))
        return force, tuple(moved)

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the force of springs and dampers; see `ContactLaw.respond`."""
        return self._move(d, v, dt, state)

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the surface is at rest and the masses ring."""
        return 0.0, self._move(0.0, 0.0, dt, state)[1]
