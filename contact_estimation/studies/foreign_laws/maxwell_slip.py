# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Hysteresis of springs that slip one after the other."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, Strength, Values


class MaxwellSlip(ContactLaw):
    """
    Parallel springs of equal stiffness, each in series with a slider.

    R = sum_i k z_i, z_i follows d within +-w_i; the widths w_i grow geometrically up to `width`.
    Iwan, J. Applied Mechanics 33(4), 1966; Al-Bender, Lampaert and Swevers, IEEE Trans. Automatic
    Control 50(11), 2005.
    """

    families = ('hysteresis', 'friction')
    stages = ('press', 'specimen', 'drive')
    elements = 6

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        width = magnitudes.depth * log_uniform(rng, 0.1, 0.4)
        stiffness = 0.4 * magnitudes.force / width
        return lambda s: {'stiffness': s * stiffness, 'width': width}

    def __init__(self, values: Values) -> None:
        super().__init__(values)
        self._widths = [self.values.width * 0.6**k for k in range(self.elements)]
        self._stiffness = self.values.stiffness / self.elements

    def start(self, dt: float, count: int) -> Any:
        """Return the last depth and the deflections of the springs, all 0 at first."""
        return (0.0, (0.0,) * self.elements)

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the sum of the springs; see `ContactLaw.respond`."""
        last, bent = state
        step = d - last
        bent = tuple([min(w, max(-w, z + step)) for z, w in zip(bent, self._widths)])
        return self._stiffness * sum(bent), (d, bent)

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the springs recover."""
        return 0.0, self.start(dt, 0)
