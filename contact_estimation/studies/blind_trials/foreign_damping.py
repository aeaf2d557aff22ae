# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Contacts that damp or relax."""

from math import exp, expm1, sqrt
from typing import Any

import numpy as np
from numpy.random import Generator

from .foreign_law import Array, ContactLaw, log_uniform, Magnitudes, Reply, Strength


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
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        tau = m.duration * log_uniform(rng, 5e-3, 0.03)
        spread = float(rng.uniform(3.0, 6.0))
        stiffness = 0.7 * m.stiffness
        return lambda s: {'stiffness': s * stiffness, 'tau': tau, 'spread': spread}

    def start(self, dt: float, count: int) -> Any:
        p = self.values
        self._arms = [(exp(-dt / tau), p.stiffness / 3.0 * tau * -expm1(-dt / tau))
                      for tau in (p.tau, p.tau * p.spread, p.tau * p.spread**2)]
        return (0.0, 0.0, 0.0)

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        arms = [fade * s + gain * v for s, (fade, gain) in zip(state, self._arms)]
        return sum(arms), arms

    def release(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        return 0.0, [fade * s for s, (fade, _) in zip(state, self._arms)]


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
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        alpha = float(rng.uniform(0.15, 0.5))
        tau = m.duration * log_uniform(rng, 0.02, 0.1)
        C = 0.8 * m.stiffness * tau**alpha
        return lambda s: {'C': s * C, 'alpha': alpha}

    def start(self, dt: float, count: int) -> Any:
        self._every = max(1, round(_STEP_S / dt))
        weights = gruenwald_weights(self.values.alpha, count // self._every + 2)
        self._weights = weights * self.values.C / (self._every * dt) ** self.values.alpha
        return 0, np.zeros(count + 1)

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        k, past = state
        past[k] = d
        seen = past[k::-self._every]
        return float(self._weights[:len(seen)] @ seen), (k + 1, past)

    def release(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        return 0.0, self.respond(t, 0.0, 0.0, dt, state)[1]


def gruenwald_weights(alpha: float, count: int) -> Array:
    """Return (-1)^k binom(alpha, k), k = 0 ... count - 1."""
    k = np.arange(1, count)
    return np.asarray(np.cumprod(np.concatenate(([1.0], 1.0 - (alpha + 1.0) / k))))


class QuasiLinearViscoelasticity(ContactLaw):
    """
    Fung's quasi-linear viscoelasticity: the elastic force relaxes, whatever its law.

    R = sum_i s_i, s_i' = (d/dt) K_i (exp(b d) - 1) / b - s_i / tau_i.
    Fung, Biomechanics: Mechanical Properties of Living Tissues, 1993.
    """

    families = ('relaxation',)
    stages = ('press', 'specimen', 'slow')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        b = float(rng.uniform(0.3, 1.2)) / m.depth
        tau = m.duration * log_uniform(rng, 5e-3, 0.03)
        stiffness = 0.6 * m.stiffness
        return lambda s: {'stiffness': s * stiffness, 'b': b, 'tau': tau}

    def start(self, dt: float, count: int) -> Any:
        self._fades = [exp(-dt / (self.values.tau * factor)) for factor in (1.0, 5.0)]
        return (0.0, 0.0)

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        rise = 0.5 * self.values.stiffness * exp(self.values.b * abs(d)) * v * dt
        arms = [fade * s + rise for s, fade in zip(state, self._fades)]
        return sum(arms), arms

    def release(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        return 0.0, [fade * s for s, fade in zip(state, self._fades)]


class TsujiDamping(ContactLaw):
    """
    Damping of colliding spheres with a constant coefficient of restitution.

    R = c abs(d)^(1/4) v in place of B_e v.
    Tsuji, Tanaka and Ishida, Powder Technology 71(3), 1992.
    """

    families = ('damping_law',)
    keeps_damper = False

    @staticmethod
    def shape(depth: float) -> float:
        """Return the power of the depth."""
        return sqrt(sqrt(depth))

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        c = 2.0 * m.force / (m.speed * cls.shape(m.depth))
        return lambda s: {'c': s * c}

    def force(self, t: float, d: float, v: float) -> float:
        return float(self.values.c * self.shape(abs(d)) * v)


class KuwabaraKono(TsujiDamping):
    """
    Damping proportional to the radius of the contact area.

    R = c sqrt(abs(d)) v in place of B_e v.
    Kuwabara and Kono, Japanese J. Applied Physics 26(8), 1987; Brilliantov et al., Physical
    Review E 53(5), 1996.
    """

    @staticmethod
    def shape(depth: float) -> float:
        return sqrt(depth)


class JankowskiPounding(KuwabaraKono):
    """
    Structures that collide lose energy while they approach, and none while they part.

    R = c sqrt(d) v for v > 0, else 0, in place of B_e v.
    Jankowski, Earthquake Engineering and Structural Dynamics 34(6), 2005.
    """

    stages = ('press',)

    def force(self, t: float, d: float, v: float) -> float:
        return super().force(t, d, max(v, 0.0))


class PowerLawDamper(ContactLaw):
    """
    A fluid viscous damper with shear-thinning orifice flow.

    R = c sgn(v) abs(v)^p, 0 < p < 1, in place of B_e v; linear below `slow`.
    Constantinou and Symans, Structural Design of Tall Buildings 2(2), 1993; Lin and Chopra,
    Earthquake Engineering and Structural Dynamics 31, 2002.
    """

    families = ('damping_law', 'friction')
    stages = ('press', 'specimen', 'drive')
    keeps_damper = False

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        p = float(rng.uniform(0.3, 0.6))
        slow, c = 0.02 * m.speed, m.force / m.speed**p
        return lambda s: {'c': s * c, 'p': p, 'slow': slow}

    def force(self, t: float, d: float, v: float) -> float:
        p = self.values
        return p.c * v * (v * v + p.slow * p.slow) ** (0.5 * (p.p - 1.0))
