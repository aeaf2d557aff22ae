# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Fractional relaxation of the wall: a memory without a time constant of its own."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import exp, expm1, inf, log, pi, sin
from operator import mul
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

from .contact_effect import ContactEffect
from .numeric import Array, Flags, Number
from .random_strength import Strength
from .scales import Scales
from ..parameters.specification import optional_parameter, ParameterGroup

_FASTEST_S, _PER_DECADE, _BRANCHES = 1e-4, 2.5, 26  # to 1e6 s, longer than a week
_SPACING = log(10.0) / _PER_DECADE
_TIMES = tuple(_FASTEST_S * exp(k * _SPACING) for k in range(_BRANCHES))
_LEAST, _MOST = 0.02, 0.98  # alpha of what is no spring and no damper yet


class _Weights(NamedTuple):
    """
    D^alpha as springs and a damper.

    Attributes
    ----------
    damper : float
        Of all branches that are faster than _TIMES [s^(1 - alpha)].
    springs : tuple of float, length _BRANCHES + 1
        One that never relaxes for all slower branches, then those of _TIMES [s^-alpha].

    """

    damper: float
    springs: tuple[float, ...]


def _weights(alpha: float) -> _Weights:
    """
    Return the branches whose sum is D^alpha.

    t^-alpha / Gamma(1 - alpha) = sin(pi alpha) / pi times the integral of q^alpha exp(-q t) over
    ln q. The trapezoidal rule is correct to 1e-4 for branches 0.4 decades apart, as is the whole
    between 1e-3 s and 1e4 s; what lies beyond the branches is a geometric series.

    """
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


@lru_cache(maxsize=4)
def _states_along(moves: bytes, bends: bytes, h: float) -> Array:
    """Solve the branches; cached, because they depend on no parameter."""
    from scipy.signal import lfilter  # slow to import, and no node needs it

    move, bend = np.frombuffer(moves), np.frombuffer(bends)
    states = np.zeros((_BRANCHES + 3, len(move)))
    states[2] = np.cumsum(move)
    kept, entered = _shares(h)
    for row, tau, k, e in zip(states[3:], _TIMES, kept[1:], entered[1:]):
        bent = tau * (0.5 * (1.0 + k) - e)
        row[:] = lfilter([1.0], [1.0, -k], e * move + bent * bend)
    states.flags.writeable = False
    return states


@dataclass(frozen=True)
class FractionalRelaxationParameters(ParameterGroup):
    """Parameters of `FractionalRelaxation`."""

    C: float = optional_parameter(
        'Force at a unit rate of order alpha', 'N s^alpha/m', minimum=0.0)
    alpha: float = optional_parameter(
        'Order of the derivative: 0 is a spring, 1 a damper', '1', minimum=0.01, maximum=0.99)


class FractionalRelaxation(ContactEffect):
    """
    R = C D^alpha d (Caputo); d = 0 out of contact, constant before the first sample.

    A sum of Maxwell branches of fixed time constants, in which alpha is in the weights alone. A
    branch is in equilibrium long before the step of an integration ends, or long after it: the
    integrated states are time and displacement since the last step, with which `settle` advances
    all branches exactly along a straight line.

    """

    name = 'fractional_relaxation'
    equation = 'F_e -= C D^alpha d'
    family = 'relaxation'
    description = 'The force relaxes over all time scales, by a power of time (springpot).'
    Parameters = FractionalRelaxationParameters

    states = _BRANCHES + 3
    weights = ('C', 'alpha')

    def __init__(self, values: FractionalRelaxationParameters) -> None:
        super().__init__(values)
        damper, springs = _weights(values.alpha)
        self._damper = values.C * damper
        self._springs = tuple(values.C * spring for spring in springs)

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return the sum of the branches; see `ContactEffect.resistance`."""
        elapsed, moved, *deflections = state
        if m is np:  # `states_along` gives branches that are up to date
            return np.array(self._springs) @ state[2:] + self._damper * v
        kept, entered = _shares(elapsed)
        past = sum(map(mul, map(mul, self._springs, kept), deflections))
        return past + sum(map(mul, self._springs, entered)) * moved + self._damper * v

    def state_rates(
        self, t: float, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Return the rates of time and displacement; see `ContactEffect.state_rates`."""
        return (1.0, v if contact else 0.0) + (0.0,) * (_BRANCHES + 1)

    def settle(
        self, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
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
        return _states_along(moves.tobytes(), bends.tobytes(), float(t[1] - t[0]))

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Return whether there is a force, of neither a spring nor a damper."""
        return bool(values.C > 0.0 and _LEAST < values.alpha < _MOST)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread alpha; the law is linear in C, which is large enough for alpha to matter."""
        return [(cls._strength(0.3, alpha, scales), alpha) for alpha in (0.1, 0.25, 0.4, 0.6, 0.8)]

    @classmethod
    def _strength(cls, share: float, alpha: float, scales: Scales) -> float:
        """Return C that adds a share of the stiffness at the pace of the motion."""
        return share * scales.spring * scales.pace**alpha

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw alpha."""
        alpha = float(rng.uniform(0.2, 0.6))
        return lambda s: {'C': cls._strength(s, alpha, scales), 'alpha': alpha}
