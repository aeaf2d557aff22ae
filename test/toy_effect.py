# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""An effect that the library does not have: R = K_5 d^5."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from contact_estimation.parameters.specification import optional_parameter, ParameterGroup
from contact_estimation.physics.contact_effect import ContactEffect
from contact_estimation.physics.drawn_effect import Scales
from contact_estimation.physics.numeric import Number


@dataclass(frozen=True)
class ToyEffectParameters(ParameterGroup):
    """Parameters of `ToyEffect`."""

    K_5: float = optional_parameter('Coefficient of the fifth power', 'N/m^5')


class ToyEffect(ContactEffect):
    """R = K_5 d^5."""

    name = 'toy_effect'
    equation = 'F_e -= K_5 d^5'
    family = 'elastic_law'
    description = 'The wall hardens suddenly.'
    Parameters = ToyEffectParameters

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return K_5 d^5."""
        return self.values.K_5 * d**5

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in K_5."""
        return [(0.002 * scales.stiffness / scales.depth**4,)]
