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

"""A wall that keeps part of the deepest dent."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np

from .physics import Array, ContactEffect, Flags, Number, positive, Scales
from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class PlasticSetParameters(ParameterGroup):
    """Parameters of `PlasticSet`."""

    residual: float = parameter(
        nan, 'Share of the deepest dent that stays', '1',
        minimum=0.0, maximum=0.999, nan_is_off=True,
    )


class PlasticSet(ContactEffect):
    """x_e = nominal + residual (greatest d so far), 0 <= residual < 1."""

    name = 'plastic_set'
    equation = 'x_e = nominal + residual (greatest d so far)'
    Parameters = PlasticSetParameters
    needs_touch = True

    states = 1  # greatest d so far, from the untouched surface

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        """Give the depth in the dent that stays; see `ContactEffect.transmit`."""
        # The dent deepens with the tool, also within a step of integration.
        deepest = state[0] + positive(d - state[0], m)
        return d - self.values.residual * deepest, v, True

    def settle(
        self, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Remember the greatest d; it counts from the untouched surface."""
        return (max(state[0], d),)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Give the running maximum of d, from the untouched surface."""
        return np.maximum.accumulate(np.maximum(d, 0.0))[None, :]

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Small and large."""
        return [(0.002,), (0.03,), (0.3,)]
