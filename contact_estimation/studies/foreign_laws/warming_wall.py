# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Wall that softens as motion warms it, and recovers as it cools."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class WarmingWall(ContactLaw):
    """
    Thixotropic softening: the warmth is the distance travelled in contact.

    R = -softening w d, w' = abs(v) - w / tau.
    Barnes, J. Non-Newtonian Fluid Mechanics 70, 1997 (thixotropy). A specimen that is moved all
    the time warms once: that is a stiffness that drifts.
    """

    stages = ('press',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        tau = float(rng.uniform(1.0, 4.0))
        most = 0.8 * magnitudes.stiffness / (0.2 * magnitudes.speed * tau)
        return lambda s: {'softening': s * most, 'tau': tau}

    def start(self, dt: float, count: int) -> Any:
        """Return the warmth, 0 at first."""
        return 0.0

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the missing spring force; see `ContactLaw.respond`."""
        state += dt * (abs(v) - state / self.values.tau)
        return -self.values.softening * state * d, state

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the wall cools."""
        return 0.0, state - dt * state / self.values.tau
