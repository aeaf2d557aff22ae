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

"""A wall that hardens or softens with time."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Any

from .physics import ContactEffect, Number, Scales
from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class StiffnessDriftParameters(ParameterGroup):
    """Parameters of `StiffnessDrift`."""

    rate: float = parameter(
        nan, 'Relative change of the stiffness in time', '1/s',
        nan_is_off=True,
    )


class StiffnessDrift(ContactEffect):
    """K_e (1 + rate t) in the linear term."""

    name = 'stiffness_drift'
    equation = 'F_e = -(K_e (1 + rate t) d + B_e v)'
    Parameters = StiffnessDriftParameters

    def spring(self, t: Number, d: Number, force: Number, m: Any) -> Number:
        """Let the stiffness drift; see `ContactEffect.spring`."""
        return force * (1.0 + self.values.rate * t)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: nearly linear."""
        return [(0.002 / scales.duration,)]
