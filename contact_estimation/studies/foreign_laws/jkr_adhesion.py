# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Adhesion of soft spheres."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.random import Generator

from .law import Array, ContactLaw, Magnitudes, Strength

_CUBE_ROOT_6 = 6.0 ** (1.0 / 3.0)
_GREATEST_RADIUS = 12.0  # of the table, in units of the contact radius without load


class JkrAdhesion(ContactLaw):
    """
    A contact area that holds on while withdrawing.

    R is the force of Johnson, Kendall and Roberts less that of Hertz at the same depth, beside
    K_e d: touching starts at d = 0 and ends at d = -reach with 5/9 of the greatest pull.
    Johnson, Kendall and Roberts, Proc. Royal Society A 324, 1971; in the form of Marshall, J.
    Computational Physics 228(5), 2009.
    """

    families = ('adhesion', 'elastic_law')
    stages = ('press',)
    pulls = True

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        reach = magnitudes.depth * float(rng.uniform(0.03, 0.15))
        return lambda s: {'pull': 0.4 * s * magnitudes.force, 'reach': reach}

    def start(self, dt: float, count: int) -> Any:
        """Return whether the surfaces hold on to each other, not at first."""
        radius = np.linspace(6.0 ** (-2.0 / 3.0), _GREATEST_RADIUS, 4000)
        depth, force = jkr_curve(radius)
        hertz = 4.0 * (np.maximum(depth, 0.0) / (2.0 * _CUBE_ROOT_6)) ** 1.5
        self._table = (depth, force - hertz)
        return False

    def _force(self, d: float) -> float:
        return float(self.values.pull * np.interp(d / self.values.reach, *self._table))

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the adhesive part; see `ContactLaw.respond`."""
        return self._force(d), True

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the pull until the surfaces part; see `ContactLaw.release`."""
        if not state or d < -self.values.reach:
            return 0.0, False
        return -self._force(d), True


def jkr_curve(radius: Array) -> tuple[Array, Array]:
    """Return the curve of Johnson, Kendall and Roberts."""
    root = np.sqrt(radius)
    return _CUBE_ROOT_6 * (2.0 * radius**2 - 4.0 / 3.0 * root), 4.0 * (radius**3 - radius * root)
