# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""An effect that the library does not have: R = K_5 d^5."""

from dataclasses import dataclass
from typing import Any

from contact_estimation.parameters import optional_parameter
from contact_estimation.physics.contact_effect import ContactEffect
from contact_estimation.physics.numeric import Number
from contact_estimation.physics.prior import Prior, Scales


@dataclass(frozen=True)
class ToyEffect(ContactEffect):
    """The wall hardens suddenly."""

    K_5: float = optional_parameter('Coefficient of the fifth power', 'N/m^5')

    equation = 'F_e -= K_5 d^5'
    family = 'elastic_law'
    description = 'The wall hardens suddenly.'

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return R."""
        return self.K_5 * d**5

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        """Let the largest harden the wall as much as the spring itself."""
        K_5 = scales.stiffness / scales.depth**4
        return Prior([(0.002 * K_5,)], largest=K_5)
