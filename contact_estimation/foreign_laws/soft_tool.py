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

"""Tool with a soft mass between sensor and tip."""

from __future__ import annotations

from math import pi

from numpy.random import Generator

from .law import Array, log_uniform, Magnitudes, SensorLaw, Signals, Strength
from .linear_filter import filtered


class SoftTool(SensorLaw):
    """
    The sensor feels a mass that follows the tool with a lag.

    y = F_e - mass (acceleration low-passed at `corner`).
    Garcia, Robertsson, Ortega and Johansson, IEEE Trans. Robotics 24(2), 2008 (tool inertia).

    """

    families = ('inertia',)
    stages = ('press', 'specimen')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        corner = log_uniform(rng, 15.0, 60.0)
        mass = 0.3 * magnitudes.force * magnitudes.depth / magnitudes.speed**2
        return lambda s: {'mass': s * mass, 'corner': corner}

    def sense(self, signals: Signals) -> Array:
        """Return the force with the inertia of the mass; see `SensorLaw.sense`."""
        dt, omega = float(signals.t[1] - signals.t[0]), 2.0 * pi * self.values.corner
        felt = filtered(signals.a, dt, [omega**2], [1.0, 1.4 * omega, omega**2])
        return signals.force - self.values.mass * felt
