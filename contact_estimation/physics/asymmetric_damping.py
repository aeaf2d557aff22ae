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

"""Damping that differs between the directions of motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .contact_effect import ContactEffect
from .numeric import Number
from .random_strength import random_sign, Strength
from .scales import Scales
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class AsymmetricDampingParameters(ParameterGroup):
    """Parameters of `AsymmetricDamping`."""

    asymmetry: float = optional_parameter(
        'Difference of the damping towards larger and smaller x, over their sum', '1',
        minimum=-1.0, maximum=1.0)


class AsymmetricDamping(ContactEffect):
    """
    B_e (v + asymmetry |v|) in place of B_e v.

    A shock absorber damps rebound more than compression (Dixon, The Shock Absorber Handbook,
    2007); colliding structures damp their approach (Jankowski 2005). No direction is driven.

    """

    name = 'asymmetric_damping'
    equation = 'F_e = -(K_e d + B_e (v + asymmetry |v|))'
    family = 'damping_law'
    description = 'Damping that differs between the two directions of motion.'
    Parameters = AsymmetricDampingParameters
    needs_return = True
    needs_speeds = True

    def damper(self, d: Number, v: Number, force: Number, exponent: float, m: Any) -> Number:
        """Return B_e (v + asymmetry |v|); see `ContactEffect.damper`."""
        return force + self.values.asymmetry * abs(force)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in the asymmetry."""
        return [(0.05,)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw the direction that is damped more."""
        sign = random_sign(rng)
        return lambda s: {'asymmetry': sign * s}
