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

"""Force that depends on the motion of another axis."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.random import Generator

from .law import Array, Magnitudes, SensorLaw, Signals, Strength


class CrossTalk(SensorLaw):
    """
    Another axis moves by random sines, unrecorded, and loads the sensor sideways.

    y = F_e + gain (sum of 6 sines between 0.1 and 2 Hz, random in phase).
    Siciliano and Khatib, Springer Handbook of Robotics, 2016 (multi-axis force sensors).

    """

    stages = ('press', 'specimen', 'drive')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        seed = float(rng.integers(1_000_000))
        return lambda s: {'gain': 0.2 * s * magnitudes.force, 'seed': seed}

    def sense(self, signals: Signals) -> Array:
        """Return the force with cross-talk; see `SensorLaw.sense`."""
        rng = np.random.default_rng(int(self.values.seed))
        other = sum(np.sin(2.0 * pi * f * signals.t + phase) for f, phase in
                    zip(rng.uniform(0.1, 2.0, 6), rng.uniform(0.0, 2.0 * pi, 6)))
        return np.asarray(signals.force + self.values.gain / 3.0**0.5 * other)
