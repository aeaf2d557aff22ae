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

"""A force sensor that was not tared."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

import numpy as np

from .physics import Array, ForceSensorEffect, Number, Scales
from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class ForceBiasParameters(ParameterGroup):
    """Parameters of `ForceBias`."""

    bias: float = parameter(nan, 'Reading without load', 'N', nan_is_off=True)


class ForceBias(ForceSensorEffect):
    """F + bias."""

    name = 'force_bias'
    equation = 'F_measured = F_e + bias'
    Parameters = ForceBiasParameters

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Add the bias; see `ForceSensorEffect.sense`."""
        return force + float(self.values.bias)

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Add the bias; see `ForceSensorEffect.sense_along`."""
        return np.asarray(force + self.values.bias)

    def undo(self, t: Number, reading: Number) -> Number:
        """Subtract the bias; see `ForceSensorEffect.undo`."""
        return reading - self.values.bias

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in bias."""
        return [(0.002 * scales.force,)]
