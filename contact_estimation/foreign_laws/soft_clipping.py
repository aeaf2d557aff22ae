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

"""Amplifier that saturates softly."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from .law import Array, Magnitudes, SensorLaw, Signals, Strength


class SoftClipping(SensorLaw):
    """
    A force sensor whose reading bends towards a limit.

    y = limit tanh(F_e / limit).
    Yeh, Abel and Smith, Proc. Digital Audio Effects, 2007 (saturating amplifiers).

    """

    families = ('limits', 'sensor_gain', 'elastic_law')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        force = magnitudes.force
        return lambda s: {'limit': force / (1.5 * max(s, 1e-6))}

    def sense(self, signals: Signals) -> Array:
        """Return the bent force; see `SensorLaw.sense`."""
        return np.asarray(self.values.limit * np.tanh(signals.force / self.values.limit))
