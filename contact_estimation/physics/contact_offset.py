# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, ContactEffect, dataclass, Need, Number, optional_parameter, Prior, Scales


@dataclass(frozen=True)
class ContactOffset(ContactEffect):
    """The surface is not where the model places it."""

    offset: float = optional_parameter('Position of the surface relative to the modelled one', 'm')

    equation = 'x_e = nominal + offset'
    family = 'clearance'
    # In an attached environment it is a bias K_e times as large.
    needs = frozenset({Need.TOUCH, Need.SPRING})

    def surface(self, t: Number, state: Any, m: Any) -> tuple[Any, Any]:
        return self.offset, 0.0

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        shares = (0.001, -0.001, 0.03, 0.1, 0.3, 0.6, 0.8, 0.95)
        return Prior([(share * scales.depth,) for share in shares], largest=0.5 * scales.depth,
                     either_sign=True)
