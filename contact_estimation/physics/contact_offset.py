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

"""A wall that stands elsewhere than the model says."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Any

from .physics import ContactEffect, Number, Scales
from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class ContactOffsetParameters(ParameterGroup):
    """Parameters of `ContactOffset`."""

    offset: float = parameter(
        nan, 'Place of the surface, from where the model has it', 'm',
        nan_is_off=True,
    )


class ContactOffset(ContactEffect):
    """x_e = nominal + offset."""

    name = 'contact_offset'
    equation = 'x_e = nominal + offset'
    Parameters = ContactOffsetParameters

    def surface(self, t: Number, state: Any, m: Any) -> tuple[Any, Any]:
        """Give the constant shift; see `ContactEffect.surface`."""
        return self.values.offset, 0.0

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Both sides."""
        return [(0.001 * scales.depth,), (-0.001 * scales.depth,)]
