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

"""Force sensor whose reading decays under load."""

from __future__ import annotations

from dataclasses import dataclass

from .force_creep import ForceCreep, ForceCreepParameters
from ..parameters.specification import optional_parameter


@dataclass(frozen=True)
class ForceDecayParameters(ForceCreepParameters):
    """Parameters of `ForceDecay`."""

    share: float = optional_parameter(
        'Force that vanishes in time, as a share of that at once', '1', minimum=0.0)


class ForceDecay(ForceCreep):
    """
    F - share y, tau y' + y = F: the creep of a load cell with the other sign.

    A specimen that relaxes looks the same: it takes the end of a contact, after which the reading
    is off, or a robot that feels the true force, to tell.

    """

    name = 'force_decay'
    equation = "F_measured = F_e - share y, tau y' + y = F_e"
    description = 'The force sensor creeps: part of a force vanishes with time.'
    Parameters = ForceDecayParameters
    needs_touch = True

    def __init__(self, values: ForceDecayParameters) -> None:
        super().__init__(values)
        self._share = -values.share
