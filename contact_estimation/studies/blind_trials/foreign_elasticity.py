# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Springs that are not linear or not constant, and adhesion."""

from math import copysign, exp, expm1, log1p, pi, sin, tanh
from typing import Any

import numpy as np
from numpy.random import Generator

from .foreign_law import Array, ContactLaw, Magnitudes, Reply, Strength


class WaltonBraun(ContactLaw):
    """
    A partly plastic contact that unloads along a steeper line.

    R = K d while loading; K_u (d - d_0) while unloading and reloading below the greatest depth,
    but not below 0; in place of K_e d. The depth is forgotten when contact is lost.
    Walton and Braun, J. Rheology 30(5), 1986.
    """

    families = ('hysteresis', 'elastic_law')
    keeps_spring = False
    rest = 0.0  # greatest depth so far

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        K = m.stiffness
        return lambda s: {'K': K, 'K_u': K * (1.0 + 2.0 * s)}

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        p, greatest = self.values, max(state, d)
        unloading = p.K * greatest - p.K_u * (greatest - d)
        return min(p.K * d, max(unloading, min(0.0, p.K * d))), greatest


class FungElasticity(ContactLaw):
    """
    A spring whose stiffness grows exponentially with the depth.

    R = K (exp(b d) - 1) / b in place of K_e d.
    Fung, American J. Physiology 213(6), 1967.
    """

    families = ('elastic_law',)
    stages = ('press', 'specimen', 'slow')
    keeps_spring = False

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        K, b = m.stiffness, 2.5 / m.depth
        return lambda s: {'K': K / (1.0 + s), 'b': max(s, 1e-6) * b}

    def force(self, t: float, d: float, v: float) -> float:
        p = self.values
        return copysign(p.K * expm1(p.b * abs(d)) / p.b, d)


class FoamPlateau(ContactLaw):
    """
    Elastic buckling of cells limits the force until they touch.

    R = K (crush tanh(d / crush) + densified (d / depth)^n), the share of a linear spring fading.
    Gibson and Ashby, Cellular Solids, 1997; Rusch, J. Applied Polymer Science 13, 1969.
    """

    families = ('elastic_law',)
    keeps_spring = False

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        crush = m.depth * float(rng.uniform(0.15, 0.35))
        densified = m.depth * float(rng.uniform(0.3, 0.7))
        n, K, depth = float(rng.integers(4, 9)), m.stiffness, m.depth
        return lambda s: {'K': K, 'share': s, 'crush': crush, 'densified': densified, 'n': n,
                          'depth': depth}

    def force(self, t: float, d: float, v: float) -> float:
        p = self.values
        dense = copysign(p.densified * abs(d / p.depth) ** p.n, d)
        foam = p.crush * tanh(d / p.crush) + dense
        return p.K * ((1.0 - p.share) * d + p.share * foam)


class NeoHookean(ContactLaw):
    """
    A block of incompressible rubber of height L without friction at its ends.

    R = K L (lambda^-2 - lambda) / 3 in place of K_e d, lambda = 1 - d / L.
    Treloar, The Physics of Rubber Elasticity, 1975.
    """

    families = ('elastic_law',)
    keeps_spring = False

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        K, depth = m.stiffness, m.depth
        return lambda s: {'K': K / (1.0 + s), 'height': depth / (0.55 * max(s, 1e-6))}

    def force(self, t: float, d: float, v: float) -> float:
        p = self.values
        stretch = max(0.1, 1.0 - d / p.height)
        return p.K * p.height / 3.0 * (stretch**-2 - stretch)


_CUBE_ROOT_6 = 6.0 ** (1.0 / 3.0)
_GREATEST_RADIUS = 12.0  # of the table, in units of the contact radius without load


class JkrAdhesion(ContactLaw):
    """
    A contact area that holds on while withdrawing.

    R is the force of Johnson, Kendall and Roberts less that of Hertz at the same depth, beside
    K_e d: touching starts at d = 0 and ends at d = -reach with 5/9 of the greatest pull.
    Johnson, Kendall and Roberts, Proc. Royal Society A 324, 1971; in the form of Marshall, J.
    Computational Physics 228(5), 2009.
    """

    families = ('adhesion', 'elastic_law')
    stages = ('press',)
    pulls = True

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        reach = m.depth * float(rng.uniform(0.03, 0.15))
        return lambda s: {'pull': 0.4 * s * m.force, 'reach': reach}

    def start(self, dt: float, count: int) -> Any:
        radius = np.linspace(6.0 ** (-2.0 / 3.0), _GREATEST_RADIUS, 4000)
        depth, force = jkr_curve(radius)
        hertz = 4.0 * (np.maximum(depth, 0.0) / (2.0 * _CUBE_ROOT_6)) ** 1.5
        self._table = (depth, force - hertz)
        return False

    def _force(self, d: float) -> float:
        return float(self.values.pull * np.interp(d / self.values.reach, *self._table))

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        return self._force(d), True

    def release(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        if not state or d < -self.values.reach:
            return 0.0, False
        return -self._force(d), True


def jkr_curve(radius: Array) -> tuple[Array, Array]:
    """Return the curve of Johnson, Kendall and Roberts."""
    root = np.sqrt(radius)
    return _CUBE_ROOT_6 * (2.0 * radius**2 - 4.0 / 3.0 * root), 4.0 * (radius**3 - radius * root)


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
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        K, most = m.stiffness, 0.5 * m.depth
        sharpness = float(rng.uniform(0.2, 0.6))
        return lambda s: {'K': K, 'gap': s * most, 'roughness': max(1e-9, sharpness * s * most)}

    def force(self, t: float, d: float, v: float) -> float:
        p = self.values
        over = (d - p.gap) / p.roughness
        rise = p.roughness * (max(over, 0.0) + log1p(exp(-abs(over))))
        return p.K * (rise - p.roughness * log1p(exp(-p.gap / p.roughness)))


class SoftSpell(ContactLaw):
    """
    A spring that fails and recovers.

    R = -softer d while first < t < last.
    Doebling, Farrar and Prime, Shock and Vibration Digest 30(2), 1998 (loss of stiffness).
    """

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        first = m.duration * float(rng.uniform(0.15, 0.6))
        last = first + m.duration * float(rng.uniform(0.1, 0.25))
        return lambda s: {'softer': 0.8 * s * m.stiffness, 'first': first, 'last': last}

    def force(self, t: float, d: float, v: float) -> float:
        return -self.values.softer * d if self.values.first < t < self.values.last else 0.0


class WarmingWall(ContactLaw):
    """
    Thixotropic softening: the warmth is the distance travelled in contact.

    R = -softening w d, w' = abs(v) - w / tau.
    Barnes, J. Non-Newtonian Fluid Mechanics 70, 1997 (thixotropy). A specimen that is moved all
    the time warms once: that is a stiffness that drifts.
    """

    stages = ('press',)
    rest = 0.0  # warmth w

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        tau = float(rng.uniform(1.0, 4.0))
        most = 0.8 * m.stiffness / (0.2 * m.speed * tau)
        return lambda s: {'softening': s * most, 'tau': tau}

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        state += dt * (abs(v) - state / self.values.tau)
        return -self.values.softening * state * d, state

    def release(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        return 0.0, state - dt * state / self.values.tau


class ForceRipple(ContactLaw):
    """
    Cogging: a force that neither grows nor fades with the depth.

    R = amplitude sin(2 pi d / wavelength).
    Jahns and Soong, IEEE Trans. Industrial Electronics 43(2), 1996 (cogging).
    """

    stages = ('press', 'specimen', 'drive')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        wavelength = m.depth / float(rng.uniform(2.0, 5.0))
        return lambda s: {'amplitude': 0.3 * s * m.force, 'wavelength': wavelength}

    def force(self, t: float, d: float, v: float) -> float:
        return self.values.amplitude * sin(2.0 * pi * d / self.values.wavelength)


class StiffnessRipple(ContactLaw):
    """
    A layered or perforated wall.

    R = K_r d sin(2 pi d / wavelength).
    Nayfeh and Mook, Nonlinear Oscillations, 1979 (parametric stiffness).
    """

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        wavelength = m.depth / float(rng.uniform(2.0, 5.0))
        return lambda s: {'stiffness': 0.5 * s * m.stiffness, 'wavelength': wavelength}

    def force(self, t: float, d: float, v: float) -> float:
        p = self.values
        return p.stiffness * d * sin(2.0 * pi * d / p.wavelength)
