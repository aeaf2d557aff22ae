# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    Any, ContactEffect, dataclass, Generator, Number, optional_parameter, Prior, Scales, Strength)


@dataclass(frozen=True)
class CubicStiffness(ContactEffect):
    """The stiffness of the wall increases or decreases with the square of the depth."""

    K_3: float = optional_parameter(
        'Coefficient of the cubic force; negative: the wall softens with depth', 'N/m^3')

    equation = 'F_e -= K_3 d^3'
    family = 'elastic_law'

    def elastic(self, d: Number, m: Any) -> Number:
        return self.K_3 * d * d * d

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.002 * scales.spring / scales.depth**2,)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        share = float(rng.choice([1.0, -0.2]))  # a softening wall must not push less when deeper
        return lambda s: {'K_3': s * share * scales.stiffness / scales.depth**2}
