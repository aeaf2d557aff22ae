# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import pi

import numpy as np

from .law import (
    Any, ContactEffect, dataclass, Generator, log_uniform, Need, Number, optional_parameter, Prior,
    Scales, Seen, Strength)
from .moving_environment import MANY_PERIODS


@dataclass(frozen=True)
class Cogging(ContactEffect):
    """
    The force ripples along the way: slots of a motor, the pitch of a screw, teeth of a gear.

    Jahns and Soong, IEEE Trans. Industrial Electronics 43(2), 1996.
    """

    amplitude: float = optional_parameter('Amplitude of the ripple', 'N', minimum=0.0)
    period: float = optional_parameter('Way from one tooth to the next', 'm', minimum=1e-15)
    phase: float = optional_parameter('Phase where d = 0', 'rad')

    equation = 'F_e -= amplitude sin(2 pi d / period + phase)'
    family = 'cogging'
    needs = frozenset({Need.ATTACHMENT})
    starts_anew = True

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        return self.amplitude * m.sin(2.0 * pi / self.period * d + self.phase)

    def may_show(self, seen: Seen) -> bool:
        """Need many periods along the way: a wave of few is any elastic law."""
        return seen.stroke > MANY_PERIODS * self.period

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # At the peaks of the residual over the way: the cost has many minima in the period.
        waves = scales.waves or ((2.0 * MANY_PERIODS / scales.depth, 0.01j * scales.force),)
        return Prior([(abs(peak), 1.0 / frequency, float(np.angle(-1j * peak)))
                      for frequency, peak in waves])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        period = scales.depth / log_uniform(rng, 2.0 * MANY_PERIODS, 8.0 * MANY_PERIODS)
        phase = float(rng.uniform(0.0, 2.0 * pi))
        return lambda s: {'amplitude': 0.3 * s * scales.force, 'period': period, 'phase': phase}
