# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .adhesion import Adhesion
from .law import Any, dataclass, Number, optional_parameter, Prior, Scales


@dataclass(frozen=True)
class DmtAdhesion(Adhesion):
    """
    The wall attracts the tool while they touch, until it is pulled off.

    Derjaguin, Muller and Toporov, J. Colloid and Interface Science 53, 1975: attraction adds to
    the elastic force without changing it. The liquid neck between wet surfaces pulls alike.
    """

    reach: float = optional_parameter(
        'Distance from the surface at which the pull ends', 'm', minimum=1e-12)

    equation = 'F_e += F_a in contact; F_e = F_a (1 + d / reach) on leaving'

    @property
    def _reach(self) -> float:
        return self.reach

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        return -self.F_a + 0.0 * v

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        pull = max(scales.greatest_pull, 0.02 * scales.force)
        return Prior([(pull, share * scales.depth) for share in (0.02, 0.1, 0.5)],
                     largest=0.7 * scales.force)
