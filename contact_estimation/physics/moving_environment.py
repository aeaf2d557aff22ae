# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import pi

import numpy as np

from .law import (
    Any, ContactEffect, dataclass, Generator, log_uniform, Need, Number, optional_parameter, Prior,
    Scales, Seen, Strength, Tone)

MANY_PERIODS = 8.0
"""Least periods in a recording of an oscillation that cannot follow any slow misfit."""


@dataclass(frozen=True)
class MovingEnvironment(ContactEffect):
    """The surface oscillates sinusoidally."""

    amplitude: float = optional_parameter('Amplitude of the surface oscillation', 'm', minimum=0.0)
    frequency: float = optional_parameter('Frequency of the oscillation', 'Hz', minimum=0.0)
    phase: float = optional_parameter('Phase of the oscillation at the first sample', 'rad')

    equation = 'x_e = nominal + amplitude sin(2 pi frequency t + phase)'
    family = 'wall_motion'
    # What none presses on moves unseen; of one stroke, time tells what depth does, too.
    needs = frozenset({Need.SPRING, Need.RETURN})

    def surface(self, t: Number, state: Any, m: Any) -> tuple[Any, Any]:
        omega = 2.0 * pi * self.frequency
        angle = omega * t + self.phase
        return self.amplitude * m.sin(angle), self.amplitude * omega * m.cos(angle)

    def is_flexible(self, seen: Seen) -> bool:
        return self.frequency * seen.duration < MANY_PERIODS

    def may_show(self, seen: Seen) -> bool:
        """Need a period: what is slower is any curve."""
        return self.frequency * seen.duration >= 1.0

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # At the peaks of the residual spectrum: the cost has many minima in frequency.
        return Prior([oscillation(tone, scales) for tone in scales.peaks()])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        frequency, phase = log_uniform(rng, 0.4, 5.0), float(rng.uniform(0.0, 2.0 * pi))
        return lambda s: {
            'amplitude': 0.3 * s * scales.depth, 'frequency': frequency, 'phase': phase}


def oscillation(tone: Tone, scales: Scales) -> tuple[float, float, float]:
    """Return the motion that a tone [Hz], [N] of the contact residual suggests."""
    frequency, peak = tone
    return abs(peak) / scales.spring, frequency, float(np.angle(1j * peak))
