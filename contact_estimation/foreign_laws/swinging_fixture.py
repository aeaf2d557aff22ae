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

"""Fixture that swings at two frequencies."""

from __future__ import annotations

from math import cos, pi, sin

from numpy.random import Generator

from .law import ContactLaw, log_uniform, Magnitudes, Strength


class SwingingFixture(ContactLaw):
    """
    The surface moves as two coupled pendulums: a beat.

    x_e = amplitude (sin(omega t + phase) + sin(ratio omega t)) / 2.
    Den Hartog, Mechanical Vibrations, 1956 (beats of coupled oscillators).

    """

    families = ('wall_motion',)
    stages = ('press',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        frequency = log_uniform(rng, 0.3, 4.0)
        ratio, phase = float(rng.uniform(0.75, 0.95)), float(rng.uniform(0.0, 2.0 * pi))
        return lambda s: {'amplitude': 0.2 * s * magnitudes.depth, 'frequency': frequency,
                          'ratio': ratio, 'phase': phase}

    def surface(self, t: float) -> tuple[float, float]:
        """Return the motion of the surface; see `ContactLaw.surface`."""
        p, omega = self.values, 2.0 * pi * self.values.frequency
        one, other = omega * t + p.phase, p.ratio * omega * t
        return (0.5 * p.amplitude * (sin(one) + sin(other)),
                0.5 * p.amplitude * omega * (cos(one) + p.ratio * cos(other)))
