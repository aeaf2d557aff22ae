# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from functools import lru_cache
from math import expm1, log1p

import numpy as np

from .law import (
    Any, Array, ContactEffect, dataclass, Flags, Generator, log_uniform, Motion, motion_of, Need,
    Number, optional_parameter, path_of, Prior, Scales, Seen, State, Strength, stretches)

_LARGEST = 50.0  # exponent; reached only by searches far from the truth
_LITTLE = 1e-9  # exponent below which the branch is linear
_STEEPEST = 0.95  # -gamma / beta: 39 times as fast back; at 1 it jumps, as friction does
_NEARLY_ONE = 1.0 - 1e-12  # exceeded only by searches far from the truth


@lru_cache(maxsize=8)
def _branch(beta: float, gamma: float, motion: Motion) -> Array:
    """Return z at each sample, from 0; cached, because searches repeat arguments."""
    path, z = path_of(motion), 0.0
    begins: list[float] = []
    zeros: list[float] = []  # distance along the leg at which z changes sign
    above, below = (_propagate(beta, gamma * sign, path.ways, path.ways) for sign in (1.0, -1.0))
    legs = zip(path.ways.tolist(), *(factor.tolist() for factor in (*above, *below)))
    for way, kept, added, kept_below, added_below in legs:
        upper = z > 0.0 or z == 0.0 < way
        after = kept * z + added if upper else kept_below * z + added_below
        begins.append(z)
        if after * z < 0.0:
            turned, signed = beta if way > 0.0 else -beta, gamma if upper else -gamma
            zeros.append(_to_zero(turned + signed, z))
            after = _from_zero(turned - signed, way - zeros[-1])
        else:
            zeros.append(2.0 * way)  # beyond the end of the leg
        z = after
    z_0, way, zero = (np.array(each)[path.leg] for each in (begins, path.ways, zeros))
    signed_all = gamma * np.where(z_0 == 0.0, np.sign(way), np.sign(z_0))
    kept_all, added_all = _propagate(beta, signed_all, path.gone, way)
    beyond = _propagate(beta, -signed_all, path.gone - zero, way)[1]
    return np.where(np.abs(path.gone) > np.abs(zero), beyond, kept_all * z_0 + added_all)


def _propagate(beta: float, gamma: float | Array, gone: Array, way: Array) -> tuple[Array, Array]:
    """Return a and b of z -> a z + b over a distance; gamma carries the sign of z."""
    c = beta * np.where(way > 0.0, 1.0, -1.0) + gamma
    x = np.clip(c * gone, -_LARGEST, None)
    little = np.abs(x) < _LITTLE
    return np.exp(-x), np.where(little, gone, -np.expm1(-x) / np.where(little, 1.0, c))


def _to_zero(c: float, z: float) -> float:
    """Return the distance after which z reaches 0."""
    return log1p(max(-c * z, -_NEARLY_ONE)) / c if c else -z


def _from_zero(c: float, gone: float) -> float:
    """Return z at a distance from its zero; a fast scalar form of `_propagate`."""
    return gone if abs(c * gone) < _LITTLE else -expm1(min(-c * gone, _LARGEST)) / c


@dataclass(frozen=True)
class BoucWenHysteresis(ContactEffect):
    """
    Hysteresis: the force differs between loading and unloading at any speed.

    z = 0 out of contact.
    """

    alpha: float = optional_parameter('Stiffness of the hysteretic branch', 'N/m', minimum=0.0)
    beta: float = optional_parameter('Rate at which the branch yields', '1/m', minimum=0.0)
    gamma: float = optional_parameter('Difference between loading and unloading', '1/m')

    equation = "F_e -= alpha z, z' = v - beta |v| z - gamma v |z|"
    family = 'hysteresis'
    # Without a spring it is friction: see `PreslidingFriction`.
    needs = frozenset({Need.RETURN, Need.SPRING})
    states = 1

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        return self.alpha * state[0]

    def state_rates(self, t: float, d: float, v: float, contact: bool, state: State) -> State:
        if not contact:
            return (0.0,)
        z = state[0]
        return (v - self.beta * abs(v) * z - self.gamma * v * abs(z),)

    def settle(self, d: float, v: float, contact: bool, state: State) -> State:
        return state if contact else (0.0,)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Solve dz = (1 - c z) dd exactly, c = beta sgn(v) + gamma sgn(z), from turn to turn."""
        states, h = np.zeros(len(t)), float(t[1] - t[0])
        for first, stop in stretches(contact):
            if not contact[first]:
                continue
            motion = motion_of(d[first:stop], v[first:stop], h, touches_down=first > 0)
            states[first:stop] = _branch(self.beta, self.gamma, motion)
        return states[None, :]

    def is_possible(self, stiffness: float, damping: float) -> bool:
        """Return whether the branch yields, and not many times as fast on the way back."""
        return self.beta > 0.0 and self.gamma > -_STEEPEST * self.beta

    def is_flexible(self, seen: Seen) -> bool:
        """Is one that gives energy: |gamma| > beta (Erlicher and Point 2004)."""
        return abs(self.gamma) > self.beta

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # With a small alpha beta and gamma would not matter.
        return Prior([(0.3 * scales.spring, share / scales.depth, 0.0)
                      for share in (0.7, 2.0, 6.0, 20.0)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw gamma of either sign; without it this is presliding friction."""
        beta = log_uniform(rng, 0.8, 8.0) / scales.depth
        gamma = float(rng.choice((-1.0, 1.0)) * rng.uniform(0.15, 0.4)) * beta
        return lambda s: {'alpha': 1.5 * s * scales.stiffness, 'beta': beta, 'gamma': gamma}
