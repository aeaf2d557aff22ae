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

"""Force periodic in the depth, as of a thread or of magnets."""

from __future__ import annotations

from math import pi, sin
from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class ForceRipple(ContactLaw):
    """
    Cogging: a force that neither grows nor fades with the depth.

    R = amplitude sin(2 pi d / wavelength).
    Jahns and Soong, IEEE Trans. Industrial Electronics 43(2), 1996 (cogging).

    """

    stages = ('press', 'specimen', 'drive')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        wavelength = magnitudes.depth / float(rng.uniform(2.0, 5.0))
        return lambda s: {'amplitude': 0.3 * s * magnitudes.force, 'wavelength': wavelength}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the periodic force; see `ContactLaw.respond`."""
        return self.values.amplitude * sin(2.0 * pi * d / self.values.wavelength), None
