# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Surfaces that move or ring."""

from math import cos, pi, sin
from typing import Any

import numpy as np
from numpy.random import Generator

from .foreign_law import ContactLaw, log_uniform, Magnitudes, Reply, Strength, Values


class BreathingSurface(ContactLaw):
    """
    The surface rests at one end of its motion, as that of a patient who breathes.

    x_e = amplitude cos^(2 n)(pi frequency t + phase).
    Lujan, Larsen, Balter and Ten Haken, Medical Physics 26(5), 1999.
    """

    families = ('wall_motion',)
    stages = ('press',)

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        frequency, power = log_uniform(rng, 0.3, 3.0), int(rng.integers(1, 4))
        phase, way = float(rng.uniform(0.0, pi)), float(rng.choice([-1.0, 1.0]))
        return lambda s: {'amplitude': 0.3 * way * s * m.depth, 'frequency': frequency,
                          'power': 2 * power, 'phase': phase}

    def surface(self, t: float) -> tuple[float, float]:
        p = self.values
        angle, power = pi * p.frequency * t + p.phase, int(p.power)
        c, s = cos(angle), sin(angle)
        return (p.amplitude * c**power,
                -p.amplitude * pi * p.frequency * power * c ** (power - 1) * s)


class BaseVibration(ContactLaw):
    """
    The surface moves at random within a band.

    x_e = a sum of 12 sines of equal amplitude between 0.5 and 2 times `frequency`, with random
    phases.
    Shinozuka and Deodatis, Applied Mechanics Reviews 44(4), 1991 (spectral representation).
    """

    stages = ('press',)

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        frequency, seed = log_uniform(rng, 8.0, 25.0), float(rng.integers(1_000_000))
        return lambda s: {'amplitude': 0.2 * s * m.depth, 'frequency': frequency, 'seed': seed}

    def __init__(self, values: Values) -> None:
        super().__init__(values)
        rng = np.random.default_rng(int(self.values.seed))
        omegas = 2.0 * pi * self.values.frequency * rng.uniform(0.5, 2.0, 12)
        phases, each = rng.uniform(0.0, 2.0 * pi, 12), self.values.amplitude / 6.0**0.5
        self._sines = list(zip(omegas.tolist(), phases.tolist()))
        self._each = each

    def surface(self, t: float) -> tuple[float, float]:
        shift = rate = 0.0
        for omega, phase in self._sines:
            shift += sin(omega * t + phase)
            rate += omega * cos(omega * t + phase)
        return self._each * shift, self._each * rate


class RingingPanel(ContactLaw):
    """
    The masses of two modes, each on its spring and damper behind the surface.

    R = sum of m (omega^2 (d - y) + 2 zeta omega (v - y')) = sum of m y''.
    Ewins, Modal Testing, 2000 (residual flexibility and modal masses).
    """

    families = ('inertia',)
    stages = ('press',)
    rest = (0.0, 0.0), (0.0, 0.0)  # displacement and velocity of both masses

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        first, zeta = log_uniform(rng, 6.0, 25.0), log_uniform(rng, 0.03, 0.15)
        ratio, share = float(rng.uniform(1.4, 3.0)), float(rng.uniform(0.2, 0.8))
        return lambda s: {'mass': 0.3 * s * m.mass, 'share': share, 'frequency': first,
                          'ratio': ratio, 'damping_ratio': zeta}

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
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

    def release(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        return 0.0, self.respond(t, 0.0, 0.0, dt, state)[1]
