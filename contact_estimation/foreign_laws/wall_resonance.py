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

"""Mass behind the surface on a spring and a damper."""

from __future__ import annotations

from math import pi
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class WallResonance(ContactLaw):
    """
    A resonance of the structure that carries the wall.

    R = m (omega^2 (d - y) + 2 zeta omega (v - y')) = m y''.
    Den Hartog, Mechanical Vibrations, 1956 (vibration absorber).

    """

    stages = ('press',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        frequency, ratio = float(rng.uniform(6.0, 25.0)), float(rng.uniform(0.03, 0.1))
        return lambda s: {'mass': 0.3 * s * magnitudes.mass, 'frequency': frequency,
                          'damping_ratio': ratio}

    def start(self, dt: float, count: int) -> Any:
        """Return displacement and velocity of the mass, 0 at first."""
        return (0.0, 0.0)

    def _move(self, d: float, v: float, dt: float, state: Any) -> tuple[float, Any]:
        p, (y, w) = self.values, state
        omega = 2.0 * pi * p.frequency
        y += 0.5 * dt * w
        pull = omega * (omega * (d - y) + 2.0 * p.damping_ratio * (v - w))
        w += dt * pull
        return p.mass * pull, (y + 0.5 * dt * w, w)

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the force of spring and damper; see `ContactLaw.respond`."""
        return self._move(d, v, dt, state)

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return no force; the surface is at rest and the mass rings."""
        return 0.0, self._move(0.0, 0.0, dt, state)[1]
