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

"""Dry friction that falls once the wall slides."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Any

from .physics import ContactEffect, Number, Scales, SIGN_VELOCITY
from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class StribeckFrictionParameters(ParameterGroup):
    """Parameters of `StribeckFriction`."""

    F_c: float = parameter(
        nan, 'Dry friction while the wall slides', 'N',
        minimum=0.0, nan_is_off=True,
    )
    F_s: float = parameter(
        nan, 'Dry friction as it begins to slide', 'N',
        minimum=0.0, nan_is_off=True,
    )
    v_s: float = parameter(
        nan, 'Speed at which the friction has fallen', 'm/s',
        minimum=1e-06, nan_is_off=True,
    )


class StribeckFriction(ContactEffect):
    """R = (F_c + (F_s - F_c) exp(-(v / v_s)^2)) sgn(v)."""

    name = 'stribeck_friction'
    equation = 'F_e -= (F_c + (F_s - F_c) exp(-(v / v_s)^2)) sgn(v)'
    Parameters = StribeckFrictionParameters
    jumps = True

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Give the falling friction; see `ContactEffect.resistance`."""
        p = self.values
        level = p.F_c + (p.F_s - p.F_c) * m.exp(-((v / p.v_s) ** 2))
        return level * m.tanh(v / SIGN_VELOCITY)

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Friction falls, F_s > F_c, and not within the smooth sign, where no one could see it."""
        return bool(values.F_s > values.F_c and values.v_s > SIGN_VELOCITY)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread v_s; the law is linear in F_c and F_s."""
        return [(0.002 * scales.force, 0.004 * scales.force, share * scales.speed)
                for share in (0.02, 0.05, 0.1, 0.2, 0.4)]
