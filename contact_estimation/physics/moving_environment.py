# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Oscillating surface."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np
from numpy.random import Generator

from .contact_effect import ContactEffect
from .drawn_effect import log_uniform, Scales, Strength, Tone
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup


MANY_PERIODS = 8.0
"""Least periods in a recording of an oscillation that cannot follow any slow misfit."""


@dataclass(frozen=True)
class MovingEnvironmentParameters(ParameterGroup):
    """Parameters of `MovingEnvironment`."""

    amplitude: float = optional_parameter('Amplitude of the surface oscillation', 'm', minimum=0.0)
    frequency: float = optional_parameter('Frequency of the oscillation', 'Hz', minimum=0.0)
    phase: float = optional_parameter('Phase of the oscillation at the first sample', 'rad')


class MovingEnvironment(ContactEffect):
    """x_e = nominal + amplitude sin(2 pi frequency t + phase)."""

    name = 'moving_environment'
    equation = 'x_e = nominal + amplitude sin(2 pi frequency t + phase)'
    family = 'wall_motion'
    description = 'The surface oscillates sinusoidally.'
    Parameters = MovingEnvironmentParameters
    needs_spring = True  # what none presses on moves unseen

    def surface(self, t: Number, state: Any, m: Any) -> tuple[Any, Any]:
        """Return the oscillation; see `ContactEffect.surface`."""
        p = self.values
        omega = 2.0 * pi * p.frequency
        angle = omega * t + p.phase
        return p.amplitude * m.sin(angle), p.amplitude * omega * m.cos(angle)

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """Is one with few periods in the recording."""
        return bool(values.frequency * duration < MANY_PERIODS)

    @classmethod
    def tones(cls, values: Any) -> tuple[float, ...]:
        """Return the frequency; see `Effect.tones`."""
        return (values.frequency,)

    @classmethod
    def is_resolved(cls, values: Any, duration: float) -> bool:
        """Need a period: what is slower is any curve."""
        return bool(values.frequency * duration >= 1.0)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Start at the peaks of the residual spectrum: the cost has many minima in frequency."""
        return [oscillation(tone, scales) for tone in scales.peaks()]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw frequency and phase."""
        frequency, phase = log_uniform(rng, 0.4, 5.0), float(rng.uniform(0.0, 2.0 * pi))
        return lambda s: {
            'amplitude': 0.3 * s * scales.depth, 'frequency': frequency, 'phase': phase}


def oscillation(tone: Tone, scales: Scales) -> tuple[float, float, float]:
    """
    Return the motion of a surface that a tone of the contact residual suggests.

    tone: frequency [Hz] and amplitude [N]
    """
    frequency, peak = tone
    return abs(peak) / scales.spring, frequency, float(np.angle(1j * peak))
