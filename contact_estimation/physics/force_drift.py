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

"""A force sensor whose zero wanders."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

import numpy as np

from .physics import Array, ForceSensorEffect, Number, Scales
from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class ForceDriftParameters(ParameterGroup):
    """Parameters of `ForceDrift`."""

    rate: float = parameter(nan, 'Change of the reading without load', 'N/s', nan_is_off=True)


class ForceDrift(ForceSensorEffect):
    """F + rate t."""

    name = 'force_drift'
    equation = 'F_measured = F_e + rate t'
    Parameters = ForceDriftParameters

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Add the drift; see `ForceSensorEffect.sense`."""
        return force + float(self.values.rate) * t

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Add the drift; see `ForceSensorEffect.sense_along`."""
        return np.asarray(force + self.values.rate * t)

    def undo(self, t: Number, reading: Number) -> Number:
        """Subtract the drift; see `ForceSensorEffect.undo`."""
        return reading - self.values.rate * t

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in rate."""
        return [(0.002 * scales.force / scales.duration,)]
