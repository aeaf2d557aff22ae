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

"""Inertia of the tool beyond the force sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .force_sensor_effect import ForceSensorEffect
from .numeric import Array
from .scales import Scales
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ToolInertiaParameters(ParameterGroup):
    """Parameters of `ToolInertia`."""

    mass: float = optional_parameter('Mass between sensor and contact', 'kg', minimum=0.0)


class ToolInertia(ForceSensorEffect):
    """F - mass a, also in free flight."""

    name = 'tool_inertia'
    equation = 'F_measured = F_e - mass a'
    family = 'inertia'
    description = 'The force sensor also measures the inertia of the tool mounted on it.'
    Parameters = ToolInertiaParameters
    needs_touch = True  # in an attached environment it is indistinguishable from M_e

    def __init__(self, values: ToolInertiaParameters) -> None:
        super().__init__(values)
        self.added_mass = values.mass

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Subtract mass a; see `ForceSensorEffect.sense`."""
        return force - float(self.values.mass) * acceleration

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Subtract mass a; see `ForceSensorEffect.sense_along`."""
        return np.asarray(force - self.values.mass * acceleration)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in mass."""
        return [(0.001 * scales.moved_mass,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return the target mass of the robot."""
        return scales.mass
