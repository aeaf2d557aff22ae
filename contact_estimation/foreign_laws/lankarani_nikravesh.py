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

"""Impact damping scaled by the speed of the impact."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class LankaraniNikravesh(ContactLaw):
    """
    Damping proportional to the depth and inversely to the speed of the touch-down.

    R = 3 (1 - e^2) / 4 K d v / v_0 in place of B_e v, v_0 the speed at the last touch-down.
    Lankarani and Nikravesh, J. Mechanical Design 112(3), 1990.

    """

    families = ('damping_law',)
    stages = ('press',)
    keeps_damper = False

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        slowest = 0.1 * magnitudes.speed
        return lambda s: {'gain': 6.0 * s * magnitudes.stiffness, 'slowest': slowest}

    def start(self, dt: float, count: int) -> Any:
        """Return the speed of the touch-down, 0 out of contact."""
        return 0.0

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the damping force; see `ContactLaw.respond`."""
        state = state or max(abs(v), self.values.slowest)
        return self.values.gain * d * v / state, state

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the next touch-down counts."""
        return 0.0, 0.0
