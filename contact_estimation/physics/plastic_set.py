# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

import numpy as np

from .law import (
    Any, Array, ContactEffect, dataclass, Flags, Need, Number, optional_parameter, positive, Prior,
    Scales, State)


@dataclass(frozen=True)
class PlasticSet(ContactEffect):
    """The wall deforms plastically: part of the deepest indentation remains."""

    residual: float = optional_parameter(
        'Fraction of the deepest indentation that remains', '1', minimum=0.0, maximum=0.999)

    equation = 'x_e = nominal + residual (greatest d so far)'
    family = 'hysteresis'
    needs = frozenset({Need.RETURN, Need.PRESSING})
    states = 1  # greatest d so far, from the untouched surface

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        # The dent deepens with the tool, also within a step of integration.
        deepest = state[0] + positive(d - state[0], m)
        return d - self.residual * deepest, v, True

    def settle(self, d: float, v: float, contact: bool, state: State) -> State:
        return (max(state[0], d),)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        return np.maximum.accumulate(np.maximum(d, 0.0))[None, :]

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.002,), (0.03,), (0.3,)], largest=0.9)
