# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from functools import cached_property, lru_cache
from math import exp, expm1, inf, log, pi, sin
from operator import mul
from typing import Any, NamedTuple

import numpy as np

from .law import (
    Array, ContactEffect, dataclass, Flags, Generator, Need, Number, optional_parameter, Prior,
    Scales, State, Strength)
from .viscoelastic_relaxation import REPELS

_FASTEST_S, _PER_DECADE, _BRANCHES = 1e-4, 2.5, 26  # to 1e6 s, longer than a week
_SPACING = log(10.0) / _PER_DECADE
_TIMES = tuple(_FASTEST_S * exp(k * _SPACING) for k in range(_BRANCHES))
_BLOCK = 32  # samples that are solved at once along a recording
_LEAST, _MOST = 0.02, 0.98  # alpha of what is no spring and no damper yet


class _Weights(NamedTuple):
    """D^alpha as springs and a damper."""

    damper: float  # of all branches that are faster than _TIMES [s^(1 - alpha)]
    # one that never relaxes for all slower branches, then those of _TIMES [s^-alpha]
    springs: tuple[float, ...]


@lru_cache(maxsize=16)
def _weights(alpha: float) -> _Weights:
    """Return the branches whose sum is D^alpha."""
    # t^-alpha / Gamma(1 - alpha) = sin(pi alpha) / pi times the integral of q^alpha exp(-q t) over
    # ln q. The trapezoidal rule is correct to 1e-4 for branches 0.4 decades apart, as is the whole
    # between 1e-3 s and 1e4 s; what lies beyond the branches is a geometric series.
    unit = sin(pi * alpha) / pi * _SPACING
    slower = unit * _TIMES[-1] ** -alpha / expm1(alpha * _SPACING)
    faster = unit * _TIMES[0] ** (1.0 - alpha) / expm1((1.0 - alpha) * _SPACING)
    return _Weights(faster, (slower, *(unit * tau**-alpha for tau in _TIMES)))


@lru_cache(maxsize=256)
def _shares(elapsed: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the shares of a branch's past and of a steady move that remain after a time."""
    if elapsed <= 0.0:
        return (1.0,) * (_BRANCHES + 1), (1.0,) * (_BRANCHES + 1)
    kept = tuple([exp(-elapsed / tau) for tau in (inf, *_TIMES)])
    return kept, (1.0, *(-tau / elapsed * expm1(-elapsed / tau) for tau in _TIMES))


class _Blocks(NamedTuple):
    """The branches over a block of samples, entered by moves and by bends of the motion."""

    powers: Array  # (_BLOCK + 1, branches) what remains of a branch after 0 to _BLOCK samples
    # (2, branches) what a branch takes of the move to a sample [m], and of its change of rate
    # [m/s]
    entered: Array

    @classmethod
    @lru_cache(maxsize=16)
    def of(cls, h: float) -> '_Blocks':
        """Return them for a sample period [s]."""
        kept, entered = map(np.array, _shares(h))
        bent = np.array((0.0, *_TIMES)) * (0.5 * (1.0 + kept) - entered)
        powers: Array = kept ** np.arange(_BLOCK + 1, dtype=float)[:, None]
        return cls(powers, np.stack((entered, bent)))

    def history(self, moves: Array, bends: Array) -> Array:
        """Return moves, bends and the branches before each block; one row for each block."""
        count = -(-len(moves) // _BLOCK)
        padded = np.zeros((2, count * _BLOCK))
        padded[:, :len(moves)] = moves, bends
        steps = padded.reshape(2, count, _BLOCK)
        ends = np.zeros((count + 1, self.powers.shape[1]))  # of the branches, from rest
        for share, step in zip(self.entered, steps):
            ends[1:] += step @ (self.powers[_BLOCK - 1::-1] * share)
        kept, apart = self.powers[_BLOCK], 1
        while apart <= count:  # what all blocks before it have left in each
            ends[apart:] += kept * ends[:-apart]
            kept, apart = kept * kept, 2 * apart
        return np.hstack((*steps, ends[:-1]))

    def force(self, springs: Array) -> Array:
        """Return what makes the force in a block of its history, shape (history, _BLOCK)."""
        kernels = np.zeros((2, _BLOCK + 1))
        kernels[:, :-1] = (self.entered * springs) @ self.powers[:-1].T
        since = np.arange(_BLOCK) - np.arange(_BLOCK)[:, None]
        since[since < 0] = _BLOCK  # the 0 at the end: nothing acts before it happens
        return np.vstack((*kernels[:, since], springs[:, None] * self.powers[1:].T))


@lru_cache(maxsize=16)
def _force_of_history(h: float, alpha: float) -> Array:
    """Return `_Blocks.force` of D^alpha; cached, since most derivatives leave alpha as it is."""
    return _Blocks.of(h).force(np.array(_weights(alpha).springs))


@dataclass(frozen=True)
class FractionalRelaxation(ContactEffect):
    """
    The force relaxes over all time scales, by a power of time (springpot).

    D^alpha of Caputo; d = 0 out of contact, constant before the first sample. It is a sum of
    Maxwell branches of fixed time constants, in which alpha is in the weights alone. Each is in
    equilibrium long before the step of an integration ends, or long after it: the integrated
    states are time and displacement since the last step, with which `settle` advances all branches
    exactly along a straight line.
    """

    C: float = optional_parameter(
        'Force at a unit rate of order alpha', 'N s^alpha/m', minimum=0.0)
    alpha: float = optional_parameter(
        'Order of the derivative: 0 is a spring, 1 a damper', '1', minimum=0.01, maximum=0.99)

    equation = 'F_e -= C D^alpha d'
    family = 'relaxation'
    relaxes = True
    needs = frozenset({Need.SPRING})  # what moves freely hangs on nothing that relaxes
    states = _BRANCHES + 3
    weights = ('C', 'alpha')

    @cached_property
    def _damper(self) -> float:
        return self.C * _weights(self.alpha).damper

    @cached_property
    def _springs(self) -> tuple[float, ...]:
        return tuple(self.C * spring for spring in _weights(self.alpha).springs)

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        if m is np:
            return self._along(t, v, state)
        elapsed, moved, *deflections = state
        kept, entered = _shares(elapsed)
        past = sum(map(mul, map(mul, self._springs, kept), deflections))
        return past + sum(map(mul, self._springs, entered)) * moved + self._damper * v

    def _along(self, t: Any, v: Any, history: Array) -> Any:
        """Return the resistance along a recording of the history of `states_along`."""
        force = history @ (self.C * _force_of_history(float(t[1] - t[0]), self.alpha))
        return force.ravel()[:len(t)] + self._damper * v

    def state_rates(self, t: float, d: float, v: float, contact: bool, state: State) -> State:
        return (1.0, v if contact else 0.0) + (0.0,) * (_BRANCHES + 1)

    def settle(self, d: float, v: float, contact: bool, state: State) -> State:
        """Advance the branches by the time and displacement since the last step."""
        elapsed, moved, *deflections = state
        kept, entered = _shares(elapsed)
        branches = [k * s + e * moved for k, s, e in zip(kept, deflections, entered)]
        return (0.0, 0.0, *branches)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Solve the branches exactly, v straight between samples in contact."""
        moves, bends = np.zeros(len(t)), np.zeros(len(t))
        moves[1:] = np.diff(np.where(contact, d, 0.0))
        bends[1:] = np.where(contact[1:] & contact[:-1], np.diff(v), 0.0)
        return _Blocks.of(float(t[1] - t[0])).history(moves, bends)

    def is_possible(self, stiffness: float, damping: float) -> bool:
        """Return whether it is neither spring nor damper, nor the spring beside it repels."""
        return (self.C > 0.0 and _LEAST < self.alpha < _MOST
                and stiffness >= -REPELS * self.C)  # the force at 1 s

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # A share of the stiffness at the pace of the motion, with which alpha matters.
        return Prior([(0.3 * scales.spring * scales.pace**alpha, alpha)
                      for alpha in (0.1, 0.25, 0.4, 0.6, 0.8)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        alpha = float(rng.uniform(0.2, 0.6))
        return lambda s: {'C': s * scales.spring * scales.pace**alpha, 'alpha': alpha}
