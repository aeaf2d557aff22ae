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

"""Surface that breathes."""

from __future__ import annotations

from math import cos, pi, sin

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, Strength


class BreathingSurface(ContactLaw):
    """
    The surface rests at one end of its motion, as that of a patient who breathes.

    x_e = amplitude cos^(2 n)(pi frequency t + phase).
    Lujan, Larsen, Balter and Ten Haken, Medical Physics 26(5), 1999.

    """

    families = ('wall_motion',)
    stages = ('press',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        frequency, power = log_uniform(rng, 0.3, 3.0), int(rng.integers(1, 4))
        phase, way = float(rng.uniform(0.0, pi)), float(rng.choice([-1.0, 1.0]))
        return lambda s: {'amplitude': 0.3 * way * s * magnitudes.depth, 'frequency': frequency,
                          'power': 2 * power, 'phase': phase}

    def surface(self, t: float) -> tuple[float, float]:
        """Return the motion of the surface; see `ContactLaw.surface`."""
        p = self.values
        angle, power = pi * p.frequency * t + p.phase, int(p.power)
        c, s = cos(angle), sin(angle)
        return (p.amplitude * c**power,
                -p.amplitude * pi * p.frequency * power * c ** (power - 1) * s)
