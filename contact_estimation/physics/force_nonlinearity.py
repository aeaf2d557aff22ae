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

"""Nonlinear characteristic of the force sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .force_sensor_effect import ForceSensorEffect
from .numeric import Array, Number
from .scales import Scales
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ForceNonlinearityParameters(ParameterGroup):
    """Parameters of `ForceNonlinearity`."""

    bend: float = optional_parameter('Relative change of the sensitivity per force', '1/N')


class ForceNonlinearity(ForceSensorEffect):
    """
    F (1 + bend |F|).

    An elastic law of the wall does the same to the force; the motion of a robot, which feels the
    true force, tells it. Fraden, Handbook of Modern Sensors, 2016, section 3.5.

    """

    name = 'force_nonlinearity'
    equation = 'F_measured = F_e (1 + bend |F_e|)'
    family = 'sensor_gain'
    description = 'The sensitivity of the force sensor changes with the force.'
    Parameters = ForceNonlinearityParameters
    needs_robot = True
    refines = 'force_gain'
    either_sign = True

    def __init__(self, values: ForceNonlinearityParameters) -> None:
        super().__init__(values)
        if values.bend < 0.0:  # beyond half of 1 / bend the reading falls
            self.limit = -0.25 / values.bend

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Change the sensitivity; see `ForceSensorEffect.sense`."""
        return force * (1.0 + float(self.values.bend) * abs(force))

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Change the sensitivity; see `ForceSensorEffect.sense_along`."""
        return np.asarray(force * (1.0 + self.values.bend * np.abs(force)))

    def undo(self, t: Number, measured: Number) -> Number:
        """Solve for F, up to where the reading falls; see `ForceSensorEffect.undo`."""
        bend = self.values.bend
        root = np.sqrt(np.maximum(1.0 + 4.0 * bend * np.abs(measured), 0.0))
        return 2.0 * measured / (1.0 + root)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Bend the greatest force by a tenth up and down."""
        return [(share / scales.force,) for share in (0.1, -0.1)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return the bend that would turn the reading at the greatest force."""
        return 0.5 / scales.force
