# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    Any, ContactEffect, dataclass, Generator, Need, Number, optional_parameter, positive, Prior,
    Scales, Strength)

_LEAST_POWER = 0.3  # of less the force is a step


@dataclass(frozen=True)
class PowerLawStiffness(ContactEffect):
    """The elastic force follows a power of the depth (Hertzian contact: 3/2)."""

    n: float = optional_parameter(
        'Exponent of the depth', '1', minimum=0.1, maximum=10.0, neutral=1.0)
    K_n: float = optional_parameter('Force at 1 m depth', 'N/m^n', minimum=0.0, logarithmic=True)

    equation = 'F_e = -(K_n d^n + B_e v)'
    family = 'elastic_law'
    needs = frozenset({Need.PRESSING})

    @property
    def exponent(self) -> float:
        return self.n

    def spring(self, d: Number, m: Any) -> Number:
        return self.K_n * positive(d, m) ** self.n

    def is_possible(self, stiffness: float, damping: float) -> bool:
        return self.n >= _LEAST_POWER

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        half, K = 0.5 * scales.depth, scales.spring  # the force at half the depth stays the same
        return Prior([(n, K * half ** (1.0 - n)) for n in (0.8, 0.95, 1.0, 1.05, 1.2, 1.5)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        most, half = float(rng.choice([1.0, -0.4])), 0.5 * scales.depth
        return lambda s: {'n': 1.0 + s * most, 'K_n': scales.stiffness * half ** (-s * most)}
