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

"""Force sensor whose gain depends on the load."""

from __future__ import annotations

from numpy.random import Generator

from .law import Array, Magnitudes, SensorLaw, Signals, Strength


class BentGauge(SensorLaw):
    """
    A sensor with a quadratic error.

    y = F_e (1 + bend F_e).
    Fraden, Handbook of Modern Sensors, 2016 (nonlinearity).
    On an attached specimen it is the same as a spring that bends: only the motion of a robot,
    which feels the true force, tells the two apart.

    """

    stages = ('press',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        bend = float(rng.choice([-0.5, 0.5])) / magnitudes.force
        return lambda s: {'bend': s * bend}

    def sense(self, signals: Signals) -> Array:
        """Return the distorted force; see `SensorLaw.sense`."""
        return signals.force * (1.0 + self.values.bend * signals.force)
