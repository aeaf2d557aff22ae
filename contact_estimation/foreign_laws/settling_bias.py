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

"""Force sensor whose zero settles after switching on."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from .law import Array, log_uniform, Magnitudes, SensorLaw, Signals, Strength


class SettlingBias(SensorLaw):
    """
    A bias that approaches a constant exponentially.

    y = F_e + bias + warm exp(-t / tau).
    Fraden, Handbook of Modern Sensors, 2016 (warm-up time).

    """

    families = ('sensor_zero',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        tau = magnitudes.duration * log_uniform(rng, 0.1, 0.6)
        warm = magnitudes.force * float(rng.choice([-0.5, 0.5]))
        ratio = float(rng.uniform(-0.8, 0.8))
        return lambda s: {'bias': s * ratio * warm, 'warm': s * warm, 'tau': tau}

    def sense(self, signals: Signals) -> Array:
        """Return the force with its bias; see `SensorLaw.sense`."""
        p = self.values
        return signals.force + p.bias + p.warm * np.exp(-signals.t / p.tau)
