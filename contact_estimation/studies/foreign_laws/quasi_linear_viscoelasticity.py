# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Relaxation of a force that is not proportional to the depth."""

from __future__ import annotations

from math import exp
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, Strength


class QuasiLinearViscoelasticity(ContactLaw):
    """
    Fung's quasi-linear viscoelasticity: the elastic force relaxes, whatever its law.

    R = sum_i s_i, s_i' = (d/dt) K_i (exp(b d) - 1) / b - s_i / tau_i.
    Fung, Biomechanics: Mechanical Properties of Living Tissues, 1993.
    """

    families = ('relaxation',)
    stages = ('press', 'specimen', 'slow')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        b = float(rng.uniform(0.3, 1.2)) / magnitudes.depth
        tau = magnitudes.duration * log_uniform(rng, 5e-3, 0.03)
        stiffness = 0.6 * magnitudes.stiffness
        return lambda s: {'stiffness': s * stiffness, 'b': b, 'tau': tau}

    def start(self, dt: float, count: int) -> Any:
        """Return the forces of the arms, 0 at first."""
        self._fades = [exp(-dt / (self.values.tau * factor)) for factor in (1.0, 5.0)]
        return (0.0, 0.0)

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the sum of the arms; see `ContactLaw.respond`."""
        rise = 0.5 * self.values.stiffness * exp(self.values.b * abs(d)) * v * dt
        arms = [fade * s + rise for s, fade in zip(state, self._fades)]
        return sum(arms), arms

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the arms relax."""
        return 0.0, [fade * s for s, fade in zip(state, self._fades)]
