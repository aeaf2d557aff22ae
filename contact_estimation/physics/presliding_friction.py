# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from functools import cached_property, lru_cache
from math import copysign, exp

import numpy as np

from .law import (
    Any, Array, ContactEffect, dataclass, Flags, Generator, log_uniform, Motion, motion_of, Need,
    Number, optional_parameter, path_of, Prior, Scales, Seen, State, Strength, stretches)


@lru_cache(maxsize=8)
def _friction(F_c: float, rate: float, motion: Motion) -> Array:
    """Return z at each sample, from 0; z / F_c approaches the sign of the travel by `rate`."""
    path, z = path_of(motion), 0.0
    ends = np.copysign(F_c, path.ways)
    begins: list[float] = []
    for end, kept in zip(ends.tolist(), np.exp(-rate * np.abs(path.ways)).tolist()):
        begins.append(z)
        z = end + (z - end) * kept
    end_of, begin_of = ends[path.leg], np.array(begins)[path.leg]
    return np.asarray(end_of + (begin_of - end_of) * np.exp(-rate * np.abs(path.gone)))


@dataclass(frozen=True)
class PreslidingFriction(ContactEffect):
    """
    Dry friction that rises over a short travel after each reversal (Dahl model).

    z = 0 out of contact.

    The sign is sharp, because z does not jump. Over a stretch u of one direction s
    z = F_c s + (z_0 - F_c s) exp(-sigma u / F_c), however fast: the integrated state is the
    displacement since the last step, with which `settle` advances z exactly.
    """

    F_c: float = optional_parameter('Friction force after a long slide', 'N', minimum=0.0)
    sigma: float = optional_parameter('Stiffness at a reversal', 'N/m', minimum=0.0)

    equation = "F_e -= z, z' = sigma v (1 - z / F_c sgn v)"
    family = 'friction'
    needs = frozenset({Need.RETURN})
    states = 2

    @cached_property
    def _rate(self) -> float:
        return self.sigma / self.F_c if self.F_c > 0.0 else 0.0

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        # `states_along` gives a z that is up to date.
        return state[1] if m is np else self._after(state[0], state[1])

    def _after(self, moved: float, z: float) -> float:
        """Return z after a stretch of one direction."""
        end = copysign(self.F_c, moved)
        return end + (z - end) * exp(-self._rate * abs(moved))

    def state_rates(self, t: float, d: float, v: float, contact: bool, state: State) -> State:
        return (v if contact else 0.0, 0.0)

    def settle(self, d: float, v: float, contact: bool, state: State) -> State:
        """Advance z by the displacement since the last step; reset it out of contact."""
        return (0.0, self._after(*state) if contact else 0.0)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """Advance z exactly from turn to turn."""
        states, h = np.zeros((2, len(t))), float(t[1] - t[0])
        for first, stop in stretches(contact):
            if contact[first]:
                motion = motion_of(d[first:stop], v[first:stop], h, touches_down=first > 0)
                states[1, first:stop] = _friction(self.F_c, self._rate, motion)
        return states

    def is_possible(self, stiffness: float, damping: float) -> bool:
        return self.F_c > 0.0 and self.sigma > 0.0

    def may_show(self, seen: Seen) -> bool:
        """Need to slide: what never does is a spring."""
        return self.F_c <= seen.force

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        F_c = 0.1 * scales.force  # over a travel that is a share of the depth
        return Prior([(F_c, F_c / (share * scales.depth))
                      for share in (0.001, 0.004, 0.015, 0.06, 0.25)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        most, travel = 0.4 * scales.force, log_uniform(rng, 0.003, 0.03) * scales.depth
        return lambda s: {'F_c': s * most, 'sigma': s * most / travel}
