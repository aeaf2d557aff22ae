# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Fractional relaxation: a spring-pot, summed over the whole past."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.random import Generator

from .law import Array, ContactLaw, log_uniform, Magnitudes, Strength

_STEP_S = 2e-3  # largest step of the sum, where the integration step is shorter


class FractionalRelaxation(ContactLaw):
    """
    A force between that of a spring and that of a damper.

    R = C D^alpha d with the derivative of Gruenwald and Letnikov,
    D^alpha d(t) = h^-alpha sum_k (-1)^k binom(alpha, k) d(t - k h), over the whole past.
    Podlubny, Fractional Differential Equations, 1999; Bonfanti et al., Soft Matter 16,
    2020.
    """

    families = ('relaxation',)
    stages = ('press', 'specimen', 'slow')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        alpha = float(rng.uniform(0.15, 0.5))
        tau = magnitudes.duration * log_uniform(rng, 0.02, 0.1)
        C = 0.8 * magnitudes.stiffness * tau**alpha
        return lambda s: {'C': s * C, 'alpha': alpha}

    def start(self, dt: float, count: int) -> Any:
        """Return the number of steps done and the depths of the past, newest last."""
        self._every = max(1, round(_STEP_S / dt))
        weights = gruenwald_weights(self.values.alpha, count // self._every + 2)
        self._weights = weights * self.values.C / (self._every * dt) ** self.values.alpha
        return 0, np.zeros(count + 1)

    def _at(self, d: float, state: Any) -> tuple[float, Any]:
        k, past = state
        past[k] = d
        seen = past[k::-self._every]
        return float(self._weights[:len(seen)] @ seen), (k + 1, past)

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the weighted sum over the past; see `ContactLaw.respond`."""
        return self._at(d, state)

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the past keeps that the surface is undeformed."""
        return 0.0, self._at(0.0, state)[1]


def gruenwald_weights(alpha: float, count: int) -> Array:
    """
    Return (-1)^k binom(alpha, k).

    Returns weights (count,): the first is 1
    """
    k = np.arange(1, count)
    return np.asarray(np.cumprod(np.concatenate(([1.0], 1.0 - (alpha + 1.0) / k))))
