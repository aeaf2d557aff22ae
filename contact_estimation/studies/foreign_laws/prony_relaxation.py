# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Relaxation with three time constants."""

from __future__ import annotations

from math import exp, expm1
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, Strength


class PronyRelaxation(ContactLaw):
    """
    Three Maxwell arms, a generalised Maxwell or Wiechert solid.

    R = sum_i s_i, s_i' = K_i v - s_i / tau_i, time constants a factor `spread` apart.
    Wiechert, Annalen der Physik 286, 1893; Tschoegl, Phenomenological Theory of Linear
    Viscoelastic Behavior, 1989.
    """

    families = ('relaxation',)
    stages = ('press', 'specimen', 'slow')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        tau = magnitudes.duration * log_uniform(rng, 5e-3, 0.03)
        spread = float(rng.uniform(3.0, 6.0))
        stiffness = 0.7 * magnitudes.stiffness
        return lambda s: {'stiffness': s * stiffness, 'tau': tau, 'spread': spread}

    def start(self, dt: float, count: int) -> Any:
        """Return the forces of the arms, 0 at first."""
        p = self.values
        self._arms = [(exp(-dt / tau), p.stiffness / 3.0 * tau * -expm1(-dt / tau))
                      for tau in (p.tau, p.tau * p.spread, p.tau * p.spread**2)]
        return (0.0, 0.0, 0.0)

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the sum of the arms, solved exactly for constant v."""
        arms = [fade * s + gain * v for s, (fade, gain) in zip(state, self._arms)]
        return sum(arms), arms

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the arms relax."""
        return 0.0, [fade * s for s, (fade, _) in zip(state, self._arms)]
