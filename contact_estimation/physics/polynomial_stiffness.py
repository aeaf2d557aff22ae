# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    Any, ContactEffect, dataclass, Generator, Number, optional_parameter, Prior, Scales, Seen,
    Strength)


@dataclass(frozen=True)
class PolynomialStiffness(ContactEffect):
    """
    The wall softens and then hardens with depth, or the reverse.

    The shortest series with a plateau: foam buckles (K_2 < 0), then its cells touch (K_3 > 0), see
    Gibson and Ashby, Cellular Solids, 1997.
    """

    K_2: float = optional_parameter('Stiffness that grows with the depth', 'N/m^2')
    K_3: float = optional_parameter('Stiffness that grows with its square', 'N/m^3', linear=True)

    equation = 'F_e -= K_2 d |d| + K_3 d^3'
    family = 'elastic_law'

    def elastic(self, d: Number, m: Any) -> Number:
        return (self.K_2 * abs(d) + self.K_3 * d * d) * d

    def is_flexible(self, seen: Seen) -> bool:
        """Return True: two powers of the depth follow any elastic misfit."""
        return True

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        K = 0.01 * scales.spring / scales.depth
        return Prior([(-K, K / scales.depth)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        # Where it is as soft as it gets, some stiffness is left.
        softest = float(rng.uniform(0.3, 0.6)) * scales.depth
        return lambda s: {'K_2': -0.9 * min(s, 1.0) * scales.stiffness / softest,
                          'K_3': 0.3 * min(s, 1.0) * scales.stiffness / softest**2}
