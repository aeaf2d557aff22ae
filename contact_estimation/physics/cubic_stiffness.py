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

"""A spring that hardens or softens with depth."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Any

from .physics import ContactEffect, Number, Scales
from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class CubicStiffnessParameters(ParameterGroup):
    """Parameters of `CubicStiffness`."""

    K_3: float = parameter(
        nan, 'Growth of the stiffness with depth; negative softens', 'N/m^3',
        nan_is_off=True,
    )


class CubicStiffness(ContactEffect):
    """R = K_3 d^3; negative softens."""

    name = 'cubic_stiffness'
    equation = 'F_e -= K_3 d^3'
    Parameters = CubicStiffnessParameters

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Give K_3 d^3; see `ContactEffect.resistance`."""
        return self.values.K_3 * d * d * d

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in K_3."""
        return [(0.002 * scales.stiffness / scales.depth**2,)]
