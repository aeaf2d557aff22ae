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

"""A wall that presses harder going in than coming out, however slowly (Bouc 1967, Wen 1976)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import expm1, log1p, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .physics import Array, ContactEffect, Flags, Number, Scales, stretches
from ..parameters import parameter, ParameterGroup

_LARGEST = 50.0  # exponent; only a search far off the truth comes there


@dataclass(frozen=True)
class BoucWenHysteresisParameters(ParameterGroup):
    """Parameters of `BoucWenHysteresis`."""

    alpha: float = parameter(
        nan, 'Stiffness of the hysteretic branch', 'N/m',
        minimum=0.0, nan_is_off=True,
    )
    beta: float = parameter(
        nan, 'Rate at which the branch yields', '1/m',
        minimum=0.0, nan_is_off=True,
    )
    gamma: float = parameter(
        nan, 'Difference between loading and unloading', '1/m',
        nan_is_off=True,
    )


def _from_turn_to_turn(gone: Array, v: Array, h: float) -> tuple[Array, NDArray[np.int_]]:
    """Split the steps in which the rate, straight between samples, changes its sign."""
    turning = np.flatnonzero(v[:-1] * v[1:] < 0.0)
    v_0, v_1, all_of_it = v[turning], v[turning + 1], gone[turning + 1]
    share = v_0 / (v_0 - v_1)
    out, back = 0.5 * h * v_0 * share, 0.5 * h * v_1 * (1.0 - share)
    # What both halves leave of the measured step is shared.
    out = out + share * (all_of_it - out - back)
    steps = gone.copy()
    steps[turning + 1] -= out
    ends = np.arange(len(gone))
    ends[1:] += np.cumsum(v[:-1] * v[1:] < 0.0)
    return np.insert(steps, turning + 1, out), ends


@lru_cache(maxsize=8)
def _branch(beta: float, gamma: float, steps_as_bytes: bytes) -> Array:
    """Give z after each step of the deflection, from 0; searches ask many times for the same."""
    steps, z = np.frombuffer(steps_as_bytes), 0.0
    along: list[float] = []
    add = along.append
    above, below = (_propagate(beta, gamma * sign, steps) for sign in (1.0, -1.0))
    for kept, added, kept_below, added_below in zip(*above, *below):
        if z > 0.0:
            after = kept * z + added
            if after < 0.0:
                after = _through_zero(beta, gamma, z, float(steps[len(along)]))
        else:
            after = kept_below * z + added_below
            if after > 0.0 > z:
                after = _through_zero(beta, -gamma, z, float(steps[len(along)]))
        z = after
        add(z)
    return np.array(along)


def _propagate(beta: float, gamma: float, steps: Array) -> tuple[list[float], list[float]]:
    """Give the factors a and b of z -> a z + b over each step, gamma with the sign of z."""
    c = beta * np.where(steps > 0.0, 1.0, -1.0) + gamma
    x = np.maximum(c * steps, -_LARGEST)
    little = np.abs(x) < 1e-9
    added = np.where(little, steps, -np.expm1(-x) / np.where(little, 1.0, c))
    return np.exp(-x).tolist(), added.tolist()


def _through_zero(beta: float, gamma: float, z: float, step: float) -> float:
    """Take a step in which z changes its sign, and so gamma: each branch as far as it reaches."""
    way = beta if step > 0.0 else -beta
    here, there = way + gamma, way - gamma
    left = step - (log1p(-here * z) / here if here else -z)
    return left if abs(there * left) < 1e-9 else -expm1(-there * left) / there


class BoucWenHysteresis(ContactEffect):
    """R = alpha z, z' = v - beta |v| z - gamma v |z|; z = 0 out of contact."""

    name = 'bouc_wen_hysteresis'
    equation = "F_e -= alpha z, z' = v - beta |v| z - gamma v |z|"
    Parameters = BoucWenHysteresisParameters

    states = 1

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Give alpha z; see `ContactEffect.resistance`."""
        return self.values.alpha * state[0]

    def state_rates(
        self, t: float, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Give z'; see `ContactEffect.state_rates`."""
        if not contact:
            return (0.0,)
        z, p = state[0], self.values
        return (v - p.beta * abs(v) * z - p.gamma * v * abs(z),)

    def settle(
        self, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Forget the branch out of contact."""
        return state if contact else (0.0,)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Solve dz = (1 - c z) dd exactly, c = beta sgn(v) + gamma sgn(z), from turn to turn."""
        beta, gamma = self.values.beta, self.values.gamma
        states, h = np.zeros(len(t)), float(t[1] - t[0])
        for first, stop in stretches(contact):
            if not contact[first]:
                continue
            inside, rate = d[first:stop], v[first:stop]
            before = float(inside[0])
            if first:  # touch-down falls between two samples: since then the tool has gone d
                before = max(0.0, before - abs(float(rate[0])) * h)
            # Only where it turns does a path matter, and it turns beyond the samples.
            steps, ends = _from_turn_to_turn(np.diff(inside, prepend=before), rate, h)
            states[first:stop] = _branch(beta, gamma, steps.tobytes())[ends]
        return states[None, :]

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Tell whether the branch yields, however differently in loading and unloading."""
        return bool(values.beta > 0.0)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread beta; alpha is large enough for beta and gamma to matter."""
        yields = (0.7, 2.0, 6.0, 20.0)
        return [(0.3 * scales.stiffness, share / scales.depth, 0.0) for share in yields]
