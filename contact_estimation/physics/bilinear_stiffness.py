# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, ContactEffect, dataclass, Number, optional_parameter, positive, Prior, Scales


@dataclass(frozen=True)
class BilinearStiffness(ContactEffect):
    """A second spring adds to the stiffness beyond a certain depth."""

    K_2: float = optional_parameter('Additional stiffness beyond `depth`', 'N/m')
    depth: float = optional_parameter('Depth at which the second spring starts', 'm', minimum=0.0)

    equation = 'F_e -= K_2 max(d - depth, 0)'
    family = 'elastic_law'

    def elastic(self, d: Number, m: Any) -> Number:
        return self.K_2 * positive(d - self.depth, m)

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # With a small K_2 the depth would be undetermined in the first step.
        shares = (0.2, 0.35, 0.5, 0.65, 0.8, 0.92)
        return Prior([(0.3 * scales.spring, share * scales.depth) for share in shares],
                     largest=2.0 * scales.stiffness)
