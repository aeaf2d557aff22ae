# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

import math

import numpy as np

from .law import (
    Any, Array, ContactEffect, dataclass, Flags, Need, Number, optional_parameter, positive, Prior,
    Scales, State)

TOLERANCE = 0.05
"""Tolerance of measured positions at the end of the play, as a share of the way to it."""


def played(steps: Array, half: float) -> Array:
    """
    Return z (N,) of z = min(half, max(-half, z + step)) from 0, for steps (N,) and half >= 0.

    Two such maps in a row are one, min(high, max(low, z + shift)): all sums of 2, 4, 8 ... steps
    follow from one another (Hillis and Steele 1986).
    """
    shift, low, high = steps.copy(), np.full(len(steps), -half), np.full(len(steps), half)
    reach = 1
    while reach < len(steps):
        later, earlier = slice(reach, None), slice(None, -reach)
        least, most = (np.clip(end[earlier] + shift[later], low[later], high[later])
                       for end in (low, high))
        shift[later] = shift[later] + shift[earlier]
        low[later], high[later] = least, most
        reach *= 2
    return np.asarray(np.clip(shift, low, high))


@dataclass(frozen=True)
class Backlash(ContactEffect):
    """
    Play between the tool and the part that touches the wall.

    The force is that of (y, y') where |x - y| = gap / 2, else 0.
    """

    gap: float = optional_parameter('Width of the play', 'm', minimum=0.0)

    equation = "F_e of (y, y'), y = play(x, gap)"
    family = 'clearance'
    needs = frozenset({Need.NO_DRIVE, Need.RETURN})
    lets_go = True
    states = 1  # position of the tool within the play, x - y

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        half, place = 0.5 * self.gap, state[0]
        # Within an integration step the state may leave the play; the tool then moves the wall.
        beyond = positive(abs(place) - half, m)
        inside = place - beyond * (2.0 * (place > 0.0) - 1.0)
        # Measured positions contain noise, which does not disengage the play.
        least = half * (1.0 - (1e-9 if m is math else TOLERANCE))
        return d - inside, v, abs(place) >= least

    def state_rates(self, t: float, d: float, v: float, contact: bool, state: State) -> State:
        return (v,)  # `settle` stops at the ends of the play

    def settle(self, d: float, v: float, contact: bool, state: State) -> State:
        half = 0.5 * self.gap
        return (min(half, max(-half, state[0])),)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        return played(np.diff(d, prepend=d[0]), 0.5 * self.gap)[None, :]

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(share * scales.depth,) for share in (0.0003, 0.003, 0.03, 0.15)],
                     largest=0.5 * scales.depth)
