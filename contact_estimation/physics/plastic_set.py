# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import isnan

import numpy as np

from .law import (
    Any, Array, ContactEffect, dataclass, Flags, Need, Number, optional_parameter, positive, Prior,
    Scales, State)


@dataclass(frozen=True)
class PlasticSet(ContactEffect):
    """
    The wall yields: beyond a depth, part of the deepest indentation remains.

    Linear hardening: beyond `yield_depth` the force grows with (1 - residual) K_e, and it unloads
    with K_e. K. L. Johnson, Contact Mechanics (1985), section 6.
    """

    residual: float = optional_parameter(
        'Fraction of the deepest indentation beyond `yield_depth` that remains', '1', minimum=0.0,
        maximum=0.999)
    yield_depth: float = optional_parameter(
        'Depth up to which the wall is elastic (0 if not given)', 'm', minimum=0.0)

    equation = 'x_e = nominal + residual max(greatest d so far - yield_depth, 0)'
    family = 'hysteresis'
    needs = frozenset({Need.RETURN, Need.PRESSING})
    states = 1  # greatest d so far, from the untouched surface

    def __post_init__(self) -> None:
        super().__post_init__()
        if isnan(self.yield_depth) and not isnan(self.residual):
            object.__setattr__(self, 'yield_depth', 0.0)

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        # The dent deepens with the tool, also within a step of integration.
        deepest = state[0] + positive(d - state[0], m)
        return d - self.residual * positive(deepest - self.yield_depth, m), v, True

    def settle(self, d: float, v: float, contact: bool, state: State) -> State:
        return (max(state[0], d),)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        return np.maximum.accumulate(np.maximum(d, 0.0))[None, :]

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        shares = (0.0, 0.2, 0.4, 0.6, 0.8)
        yields = [(0.3, share * scales.depth) for share in shares]
        return Prior([(0.002, 0.0), (0.03, 0.0), *yields], largest=0.9)
