# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

import numpy as np

from .law import (
    Any, Array, ContactEffect, dataclass, Flags, Need, Number, optional_parameter, Prior, Scales,
    State)

NECK = 1.5e-3
"""Distance from the surface at which adhesion ends [m]."""


@dataclass(frozen=True)
class Adhesion(ContactEffect):
    """The wall sticks to the tool and pulls it back on withdrawal."""

    F_a: float = optional_parameter('Largest pull of the wall', 'N', minimum=0.0)

    equation = 'F_e <= F_a in contact; F_e = F_a (1 + d / 1.5 mm) on leaving'
    family = 'adhesion'
    needs = frozenset({Need.TOUCH})
    states = 1  # 1 from touch-down until the neck has torn

    @property
    def _reach(self) -> float:
        return NECK

    @property
    def pull(self) -> float:
        return self.F_a

    def tail(self, d: Number, v: Number, state: Any, m: Any) -> Number:
        holds = (state[0] > 0.5) * (v < 0.0) * (d > -self._reach)
        return holds * self.F_a * (1.0 + d / self._reach)

    def settle(self, d: float, v: float, contact: bool, state: State) -> State:
        return (1.0,) if contact else (state[0] if d > -self._reach else 0.0,)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        index = np.arange(1, len(t) + 1)
        touched = np.maximum.accumulate(np.where(contact, index, 0))
        torn = np.maximum.accumulate(np.where(d <= -self._reach, index, 0))
        return (touched > torn).astype(float)[None, :]

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        pull = max(scales.greatest_pull, 0.02 * scales.force)
        return Prior([(pull,)], largest=0.7 * scales.force)
