# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .hunt_crossley_damping import LARGEST_DAMPING
from .law import (
    Any, ContactEffect, dataclass, Generator, Number, optional_parameter, Prior, Scales, Strength)


@dataclass(frozen=True)
class PowerLawDamping(ContactEffect):
    """
    The damping of the wall follows a power of the depth (spheres: 1/4 to 3/2).

    m = 1/4: Tsuji, Tanaka and Ishida (1992); 1/2: Kuwabara and Kono (1987); 1: Hunt and Crossley
    (1975), which has a name of its own.
    """

    B_m: float = optional_parameter(
        'Damping at 1 m depth', 'N s/m/m^m', minimum=0.0, logarithmic=True)
    m: float = optional_parameter('Exponent of the depth', '1', minimum=0.0, maximum=4.0)

    equation = 'F_e = -(K_e d + B_m abs(d)^m v)'
    family = 'damping_law'

    def damper(self, d: Number, v: Number, exponent: float, m: Any) -> Number:
        return self.B_m * abs(d) ** self.m * v

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        half = 0.5 * scales.depth
        return Prior([(scales.damper / half**m, m) for m in (0.25, 0.5, 1.0, 1.5)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        m, half = float(rng.choice([0.25, 0.5, 1.5])), 0.5 * scales.depth
        return lambda s: {'B_m': s * LARGEST_DAMPING / half**m, 'm': m}
