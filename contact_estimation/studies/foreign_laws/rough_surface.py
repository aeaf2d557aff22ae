# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rough surface: asperities touch one after the other."""

from __future__ import annotations

from math import exp, log1p
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class RoughSurface(ContactLaw):
    """
    Asperities with exponentially distributed heights soften the first touch.

    R = K h (log(1 + exp((d - gap) / h)) - log(1 + exp(-gap / h))) in place of K_e d: an
    exponential onset over the roughness h, then a spring from the mean plane at `gap`.
    Greenwood and Williamson, Proc. Royal Society A 295, 1966; Pohrt and Popov, PRL 108, 2012.
    """

    families = ('clearance', 'elastic_law')
    stages = ('press',)
    keeps_spring = False

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        K, most = magnitudes.stiffness, 0.5 * magnitudes.depth
        sharpness = float(rng.uniform(0.2, 0.6))
        return lambda s: {'K': K, 'gap': s * most, 'roughness': max(1e-9, sharpness * s * most)}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the elastic force; see `ContactLaw.respond`."""
        p = self.values
        over = (d - p.gap) / p.roughness
        rise = p.roughness * (max(over, 0.0) + log1p(exp(-abs(over))))
        return p.K * (rise - p.roughness * log1p(exp(-p.gap / p.roughness))), None
