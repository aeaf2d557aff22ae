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

"""Rubber block under compression."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class NeoHookean(ContactLaw):
    """
    A block of incompressible rubber of height L without friction at its ends.

    R = K L (lambda^-2 - lambda) / 3 in place of K_e d, lambda = 1 - d / L.
    Treloar, The Physics of Rubber Elasticity, 1975.

    """

    families = ('elastic_law',)
    keeps_spring = False

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        K, depth = magnitudes.stiffness, magnitudes.depth
        return lambda s: {'K': K / (1.0 + s), 'height': depth / (0.55 * max(s, 1e-6))}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the elastic force; see `ContactLaw.respond`."""
        p = self.values
        stretch = max(0.1, 1.0 - d / p.height)
        return p.K * p.height / 3.0 * (stretch**-2 - stretch), None
