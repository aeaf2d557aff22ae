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
from math import expm1, nan
from typing import Any

import numpy as np

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
        """Solve dz = (1 - c z) dd exactly, c = beta sgn(v) + gamma sgn(z), over each sample."""
        z, beta, gamma = 0.0, self.values.beta, self.values.gamma
        states = np.zeros(len(t))
        for first, stop in stretches(contact):
            if not contact[first]:
                continue
            z, along = 0.0, []
            before = float(d[first])
            if first:  # touch-down falls between two samples: since then the tool has gone d
                before = max(0.0, before - abs(float(v[first])) * float(t[1] - t[0]))
            steps = np.diff(d[first:stop], prepend=before)
            for step in steps.tolist():
                c = (beta if step > 0.0 else -beta) + (gamma if z > 0.0 else -gamma)
                x = max(c * step, -_LARGEST)
                z += (1.0 - c * z) * (step if abs(x) < 1e-9 else -expm1(-x) / c)
                along.append(z)
            states[first:stop] = along
        return states[None, :]

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Tell whether z stays bounded: beta + gamma > 0 (Ikhouane and Rodellar 2007)."""
        return bool(values.beta + values.gamma > 0.0)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread beta; the law is linear in alpha."""
        yields = (0.7, 2.0, 6.0, 20.0)
        return [(0.01 * scales.stiffness, share / scales.depth, 0.0) for share in yields]
