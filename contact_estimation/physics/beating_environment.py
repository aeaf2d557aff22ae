# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Surface that oscillates at two frequencies."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from math import pi
from typing import Any

from numpy.random import Generator

from .contact_effect import ContactEffect
from .drawn_effect import log_uniform, Scales, Strength
from .moving_environment import MovingEnvironment, MovingEnvironmentParameters, oscillation
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup

_PERIODS = 3.0  # fewest of the slower tone


@dataclass(frozen=True)
class BeatingEnvironmentParameters(ParameterGroup):
    """Parameters of `BeatingEnvironment`."""

    amplitude: float = optional_parameter('Amplitude of the first oscillation', 'm', minimum=0.0)
    frequency: float = optional_parameter('Its frequency', 'Hz', minimum=0.0)
    phase: float = optional_parameter('Its phase at the first sample', 'rad')
    amplitude_2: float = optional_parameter('Amplitude of the second one', 'm', minimum=0.0)
    frequency_2: float = optional_parameter('Its frequency', 'Hz', minimum=0.0)
    phase_2: float = optional_parameter('Its phase at the first sample', 'rad')


class BeatingEnvironment(ContactEffect):
    """
    x_e = nominal + the sum of two oscillations: a beat, or a period that is no sine.

    Den Hartog, Mechanical Vibrations, 1956 (coupled oscillators); a breathing patient: Lujan,
    Larsen, Balter and Ten Haken, Medical Physics 26(5), 1999.
    """

    name = 'beating_environment'
    equation = ('x_e = nominal + amplitude sin(2 pi frequency t + phase)'
                ' + amplitude_2 sin(2 pi frequency_2 t + phase_2)')
    family = 'wall_motion'
    description = 'The surface oscillates at two frequencies: a beat, or a motion with harmonics.'
    Parameters = BeatingEnvironmentParameters
    needs_spring = True  # what none presses on moves unseen

    def __init__(self, values: BeatingEnvironmentParameters) -> None:
        super().__init__(values)
        p = values
        self._tones = tuple(
            MovingEnvironment(MovingEnvironmentParameters(*tone)) for tone in (
                (p.amplitude, p.frequency, p.phase), (p.amplitude_2, p.frequency_2, p.phase_2)))

    def surface(self, t: Number, state: Any, m: Any) -> tuple[Any, Any]:
        """Return the sum of both oscillations; see `ContactEffect.surface`."""
        (x, v), (y, w) = (tone.surface(t, state, m) for tone in self._tones)
        return x + y, v + w

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """Is one with few periods in the recording."""
        slower = min(values.frequency, values.frequency_2)
        tone = MovingEnvironmentParameters(0.0, slower, 0.0)
        return MovingEnvironment.is_flexible(tone, duration)

    @classmethod
    def tones(cls, values: Any) -> tuple[float, ...]:
        """Return both frequencies; see `Effect.tones`."""
        return values.frequency, values.frequency_2

    @classmethod
    def is_resolved(cls, values: Any, duration: float) -> bool:
        """
        Need periods, and one that the tones gain on one another (Rayleigh's criterion).

        Two tones of fewer than three periods are any curve of time.
        """
        low, high = sorted((values.frequency, values.frequency_2))
        return bool(min(low / _PERIODS, high - low) * duration >= 1.0)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Start at the two tones that fit the residual best, and at pairs of its peaks."""
        pairs = [scales.beat] if scales.beat else []
        pairs += combinations(scales.peaks(), 2)
        if not pairs:  # nothing is known of the residual
            (frequency, peak), = scales.peaks()
            pairs = [((frequency, peak), (2.0 * frequency, 0.5 * peak))]
        return [sum((oscillation(tone, scales) for tone in pair), ()) for pair in pairs]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw frequencies, phases and the ratio of the amplitudes."""
        first, ratio = log_uniform(rng, 0.4, 3.0), float(rng.uniform(1.15, 2.5))
        phases = rng.uniform(0.0, 2.0 * pi, 2).tolist()
        share = float(rng.uniform(0.3, 1.0))
        return lambda s: {
            'amplitude': 0.2 * s * scales.depth, 'frequency': first, 'phase': phases[0],
            'amplitude_2': 0.2 * share * s * scales.depth, 'frequency_2': ratio * first,
            'phase_2': phases[1]}
