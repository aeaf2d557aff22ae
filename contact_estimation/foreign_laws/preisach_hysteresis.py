# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Preisach hysteresis: relays of all widths, remembered by their extrema."""

from __future__ import annotations

from math import exp
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, sign, Strength


class PreisachHysteresis(ContactLaw):
    """
    Relays with a density that falls exponentially with their width.

    R is the opposite of their sum, since relays switch late, beside a spring amplitude / w, so
    that no wall has a negative stiffness. Going away from an extremum d_k, R changes by
    h amplitude / w - E(h), h = abs(d - d_k), with the Everett function
    E(h) = amplitude (h / w - 1 + exp(-h / w)); a loop that closes is forgotten. The virgin curve
    has half the change at twice the depth.
    Mayergoyz, Mathematical Models of Hysteresis, 1991; Preisach, Z. Physik 94, 1935.

    """

    families = ('hysteresis', 'friction')
    stages = ('press', 'specimen')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        width = magnitudes.depth * log_uniform(rng, 0.1, 0.5)
        amplitude = 0.15 * magnitudes.force
        return lambda s: {'amplitude': s * amplitude, 'width': width}

    def change(self, h: float) -> float:
        """Return the change of R at a distance h >= 0 from the last extremum [N]."""
        return float(self.values.amplitude * (1.0 - exp(-h / self.values.width)))

    def start(self, dt: float, count: int) -> Any:
        """Return last depth, its force, its direction and the extrema passed before."""
        return (0.0, 0.0, 0.0, ())

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the force after forgetting the loops closed by this step."""
        last, force, way, extrema = state
        now = sign(d - last)
        if now == 0.0:
            return force, state
        if now == -way:
            extrema = (*extrema, (last, force))
        # A branch that passes the extremum before its own start continues the older branch.
        while len(extrema) > 1 and now * (d - extrema[-2][0]) >= 0.0:
            extrema = extrema[:-2]
        if len(extrema) == 1 and abs(d) >= abs(extrema[0][0]) and d * extrema[0][0] < 0.0:
            extrema = ()
        if extrema:
            origin, at_origin = extrema[-1]
            force = at_origin + now * self.change(abs(d - origin))
        else:
            force = 0.5 * sign(d) * self.change(2.0 * abs(d))
        return force, (d, force, now, extrema)

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; everything is forgotten."""
        return 0.0, self.start(dt, 0)
