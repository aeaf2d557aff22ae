# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Friction and hysteresis in the contact."""

from math import exp, pi, sin, sqrt, tanh
from typing import Any

from numpy.random import Generator

from .foreign_law import ContactLaw, log_uniform, Magnitudes, Reply, sign, Strength, Values


class LugreFriction(ContactLaw):
    """
    Friction of bristles with Stribeck's curve.

    R = sigma_0 z + sigma_1 z', z' = v - sigma_0 abs(v) z / g(v),
    g(v) = F_c + (F_s - F_c) exp(-(v / v_s)^2).
    Canudas de Wit, Olsson, Astrom and Lischinsky, IEEE Trans. Automatic Control 40(3), 1995. The
    law of Bouc and Wen contains that of Dahl, which this one extends.
    """

    families = ('friction', 'hysteresis')
    stages = ('press', 'specimen', 'drive')
    rest = 0.0  # deflection z of the bristles

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        F_c = 0.3 * m.force
        ratio = float(rng.uniform(1.05, 1.8))
        v_s = m.speed * log_uniform(rng, 0.02, 0.2)
        bend = m.depth * log_uniform(rng, 1e-3, 1e-2)
        sigma_0 = F_c / bend
        sigma_1 = 0.2 * sqrt(sigma_0 * m.mass)
        return lambda s: {'F_c': s * F_c, 'F_s': s * ratio * F_c, 'v_s': v_s,
                          'sigma_0': s * sigma_0, 'sigma_1': s * sigma_1}

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        p = self.values
        g = p.F_c + (p.F_s - p.F_c) * exp(-(v / p.v_s) ** 2)
        slid = exp(-p.sigma_0 * abs(v) * dt / g)
        z = slid * state + (1.0 - slid) * g * sign(v) / p.sigma_0
        return p.sigma_0 * z + p.sigma_1 * (z - state) / dt, z


class ElastoplasticFriction(ContactLaw):
    """
    Bristles that do not creep below their break-away deflection.

    R = sigma_0 z + sigma_1 z', z' = v (1 - alpha(z, v) z / z_ss) with z_ss = F_c / sigma_0; alpha
    is 0 below z_ba, rises as a half sine to 1 at z_ss, and is 0 where v unloads the bristles.
    Dupont, Hayward, Armstrong and Altpeter, IEEE Trans. Automatic Control 47(5), 2002.
    """

    families = ('friction', 'hysteresis')
    stages = ('press', 'specimen', 'drive')
    rest = 0.0  # deflection z of the bristles

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        F_c = 0.3 * m.force
        z_ss = m.depth * log_uniform(rng, 1e-3, 1e-2)
        share = float(rng.uniform(0.3, 0.9))
        damping = 0.2 * sqrt(F_c / z_ss * m.mass)
        return lambda s: {'F_c': s * F_c, 'z_ss': z_ss, 'z_ba': share * z_ss,
                          'sigma_1': s * damping}

    def _slipping(self, z: float, v: float) -> float:
        """Return alpha, the plastic share of the motion."""
        p = self.values
        if z * v <= 0.0 or abs(z) <= p.z_ba:
            return 0.0
        if abs(z) >= p.z_ss:
            return 1.0
        middle = 0.5 * (p.z_ss + p.z_ba)
        return 0.5 + 0.5 * sin(pi * (abs(z) - middle) / (p.z_ss - p.z_ba))

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        p = self.values
        z = state + dt * v * (1.0 - self._slipping(state, v) * abs(state) / p.z_ss)
        z = min(p.z_ss, max(-p.z_ss, z))
        return p.F_c / p.z_ss * z + p.sigma_1 * (z - state) / dt, z


class AsymmetricCoulomb(ContactLaw):
    """
    Coulomb friction F_in going in and F_out going out, reached over a short elastic bend.

    R' = stiffness v within -F_out <= R <= F_in.
    Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica 30(7), 1994.
    """

    families = ('friction',)
    stages = ('press', 'specimen', 'drive')
    rest = 0.0  # friction R

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        F_in = 0.3 * m.force
        ratio = float(rng.choice([log_uniform(rng, 0.5, 0.8), log_uniform(rng, 1.25, 2.0)]))
        stiffness = F_in / (m.depth * log_uniform(rng, 1e-3, 5e-3))
        return lambda s: {'F_in': s * F_in, 'F_out': s * ratio * F_in, 'stiffness': s * stiffness}

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        p = self.values
        force = min(p.F_in, max(-p.F_out, state + p.stiffness * v * dt))
        return force, force


class MagnetorheologicalDamper(ContactLaw):
    """
    A yielding fluid, its yield force delayed by the elasticity of damper and gas.

    R = force tanh(v / v_0 + lead tanh(d / x_0)).
    Kwok, Ha, Nguyen, Li and Samali, Sensors and Actuators A 132(2), 2006.
    """

    families = ('friction', 'hysteresis')
    stages = ('specimen', 'drive')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        v_0 = m.speed * log_uniform(rng, 0.05, 0.3)
        lead, x_0 = float(rng.uniform(0.1, 0.6)), 0.1 * m.depth
        force = 0.4 * m.force
        return lambda s: {'force': s * force, 'v_0': v_0, 'lead': lead, 'x_0': x_0}

    def force(self, t: float, d: float, v: float) -> float:
        p = self.values
        return p.force * tanh(v / p.v_0 + p.lead * tanh(d / p.x_0))


class MaxwellSlip(ContactLaw):
    """
    Parallel springs of equal stiffness, each in series with a slider.

    R = sum_i k z_i, z_i follows d within +-w_i; the widths w_i grow geometrically up to `width`.
    Iwan, J. Applied Mechanics 33(4), 1966; Al-Bender, Lampaert and Swevers, IEEE Trans. Automatic
    Control 50(11), 2005.
    """

    families = ('hysteresis', 'friction')
    stages = ('press', 'specimen', 'drive')
    rest = 0.0, (0.0,) * 6  # last depth and the deflections of the springs

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        width = m.depth * log_uniform(rng, 0.1, 0.4)
        stiffness = 0.4 * m.force / width
        return lambda s: {'stiffness': s * stiffness, 'width': width}

    def __init__(self, values: Values) -> None:
        super().__init__(values)
        self._widths = [self.values.width * 0.6**k for k in range(6)]
        self._stiffness = self.values.stiffness / 6

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        last, bent = state
        step = d - last
        bent = tuple([min(w, max(-w, z + step)) for z, w in zip(bent, self._widths)])
        return self._stiffness * sum(bent), (d, bent)


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
    rest = 0.0, 0.0, 0.0, ()  # last depth, R, its direction and the extrema before

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        width = m.depth * log_uniform(rng, 0.1, 0.5)
        amplitude = 0.15 * m.force
        return lambda s: {'amplitude': s * amplitude, 'width': width}

    def change(self, h: float) -> float:
        """Return the change of R at a distance h >= 0 from the last extremum [N]."""
        return float(self.values.amplitude * (1.0 - exp(-h / self.values.width)))

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
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
