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

"""Robot with drag proportional to the square of its speed."""

from __future__ import annotations

from numpy.random import Generator

from .law import Magnitudes, RobotLaw, Strength


class Windage(RobotLaw):
    """
    Aerodynamic or churning drag.

    Drag c v abs(v).
    Batchelor, An Introduction to Fluid Dynamics, 1967.

    """

    families = ('robot',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        c = 2.0 * magnitudes.control / magnitudes.speed**2
        return lambda s: {'c': s * c}

    def drive(
        self, u: float, x: float, v: float, dt: float, state: float
    ) -> tuple[float, float]:
        """Return the force less the drag; see `RobotLaw.drive`."""
        return u - self.values.c * v * abs(v), state
