# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from math import pi

from .law import (
    Any, ContactEffect, Generator, log_uniform, Need, Number, optional_parameter, Prior, Scales,
    Seen, Strength)
from .moving_environment import MANY_PERIODS, MovingEnvironment, oscillation

_PERIODS = 3.0  # fewest of the slower tone


@dataclass(frozen=True)
class BeatingEnvironment(ContactEffect):
    """
    The surface oscillates at two frequencies: a beat, or a motion with harmonics.

    Den Hartog, Mechanical Vibrations, 1956 (coupled oscillators); a breathing patient: Lujan,
    Larsen, Balter and Ten Haken, Medical Physics 26(5), 1999.
    """

    amplitude: float = optional_parameter('Amplitude of the first oscillation', 'm', minimum=0.0)
    frequency: float = optional_parameter('Its frequency', 'Hz', minimum=0.0)
    phase: float = optional_parameter('Its phase at the first sample', 'rad')
    amplitude_2: float = optional_parameter('Amplitude of the second one', 'm', minimum=0.0)
    frequency_2: float = optional_parameter('Its frequency', 'Hz', minimum=0.0)
    phase_2: float = optional_parameter('Its phase at the first sample', 'rad')

    equation = ('x_e = nominal + amplitude sin(2 pi frequency t + phase)'
                ' + amplitude_2 sin(2 pi frequency_2 t + phase_2)')
    family = 'wall_motion'
    # What none presses on moves unseen; of one stroke, time tells what depth does, too.
    needs = frozenset({Need.SPRING, Need.RETURN})

    def surface(self, t: Number, state: Any, m: Any) -> tuple[Any, Any]:
        (x, v), (y, w) = (tone.surface(t, state, m) for tone in self._tones)
        return x + y, v + w

    @cached_property
    def _tones(self) -> tuple[MovingEnvironment, MovingEnvironment]:
        return (MovingEnvironment(self.amplitude, self.frequency, self.phase),
                MovingEnvironment(self.amplitude_2, self.frequency_2, self.phase_2))

    def is_flexible(self, seen: Seen) -> bool:
        return min(self.frequency, self.frequency_2) * seen.duration < MANY_PERIODS

    def may_show(self, seen: Seen) -> bool:
        """Need periods, and one that the tones gain on one another (Rayleigh's criterion)."""
        # Two tones of fewer than three periods are any curve of time.
        low, high = sorted((self.frequency, self.frequency_2))
        return min(low / _PERIODS, high - low) * seen.duration >= 1.0

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # The two tones that fit the residual best, and pairs of its peaks.
        pairs = [scales.beat] if scales.beat else []
        pairs += combinations(scales.peaks(), 2)
        if not pairs:  # nothing is known of the residual
            (frequency, peak), = scales.peaks()
            pairs = [((frequency, peak), (2.0 * frequency, 0.5 * peak))]
        return Prior([sum((oscillation(tone, scales) for tone in pair), ()) for pair in pairs])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        first, ratio = log_uniform(rng, 0.4, 3.0), float(rng.uniform(1.15, 2.5))
        phases = rng.uniform(0.0, 2.0 * pi, 2).tolist()
        share = float(rng.uniform(0.3, 1.0))
        return lambda s: {
            'amplitude': 0.2 * s * scales.depth, 'frequency': first, 'phase': phases[0],
            'amplitude_2': 0.2 * share * s * scales.depth, 'frequency_2': ratio * first,
            'phase_2': phases[1]}
