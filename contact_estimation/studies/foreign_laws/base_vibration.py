# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Vibration of the floor under the wall."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, Strength, Values


class BaseVibration(ContactLaw):
    """
    The surface moves at random within a band.

    x_e = a sum of 12 sines of equal amplitude between 0.5 and 2 times `frequency`, with random
    phases.
    Shinozuka and Deodatis, Applied Mechanics Reviews 44(4), 1991 (spectral representation).
    """

    stages = ('press',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        frequency, seed = log_uniform(rng, 8.0, 25.0), float(rng.integers(1_000_000))
        return lambda s: {'amplitude': 0.2 * s * magnitudes.depth, 'frequency': frequency,
                          'seed': seed}

    def __init__(self, values: Values) -> None:
        super().__init__(values)
        rng = np.random.default_rng(int(self.values.seed))
        omegas = 2.0 * pi * self.values.frequency * rng.uniform(0.5, 2.0, 12)
        phases, each = rng.uniform(0.0, 2.0 * pi, 12), self.values.amplitude / 6.0**0.5
        self._sines = list(zip(omegas.tolist(), phases.tolist()))
        self._each = each

    def surface(self, t: float) -> tuple[float, float]:
        """Return the motion of the surface; see `ContactLaw.surface`."""
        shift = rate = 0.0
        for omega, phase in self._sines:
            shift += sin(omega * t + phase)
            rate += omega * cos(omega * t + phase)
        return self._each * shift, self._each * rate
