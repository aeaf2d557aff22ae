# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Experiments: setpoints over time."""

from __future__ import annotations

import bisect
from dataclasses import dataclass
from math import nan

from .excitation import Excitation
from .quintic import quintic
from .setpoints import Desired

START = -0.10
"""Default position before an experiment [m]."""


@dataclass(frozen=True)
class Segment:
    """Quintic motion to a position, with superposed excitation."""

    duration: float  # duration [s], > 0
    position: float  # final position [m]; equal to the previous one for a hold
    force: float = nan  # F_d [N], positive while pressing; NaN: no force prescribed
    # force_excitation, position_excitation: added to F_d [N] and x_d [m]; functions of the time
    # since the start of the experiment
    force_excitation: Excitation | None = None
    position_excitation: Excitation | None = None


class Experiment:
    """
    A sequence of segments.

    start: position before the first segment [m]
    """

    def __init__(self, name: str, start: float, segments: tuple[Segment, ...]) -> None:
        self.name, self.start, self.segments = name, start, segments
        self._repeats = False
        self._begins = [0.0]
        for segment in segments:
            self._begins.append(self._begins[-1] + segment.duration)

    @property
    def duration(self) -> float:
        """Total duration [s]."""
        return self._begins[-1]

    def cyclic(self) -> 'Experiment':
        """Return the experiment as an endless cycle."""
        segments = self.segments
        if segments[-1].position != self.start:
            segments = (*segments, Segment(segments[0].duration, self.start))
        cycle = Experiment(self.name, self.start, segments)
        cycle._repeats = True
        return cycle

    def desired(self, t: float) -> Desired:
        """
        Return the setpoint at a given time.

        t: time since the start [s]; before and after the experiment the setpoint rests, unless it
        is a cycle
        """
        if self._repeats and t >= 0.0:
            t %= self.duration
        index = bisect.bisect_right(self._begins, t) - 1
        if index < 0 or index >= len(self.segments):
            rest = self.start if index < 0 else self.segments[-1].position
            return Desired(rest, 0.0, 0.0, nan)
        segment = self.segments[index]
        before = self.segments[index - 1].position if index else self.start
        since = t - self._begins[index]
        x, v, a = quintic(before, segment.position, segment.duration, since)
        if segment.position_excitation is not None:
            first, second = segment.position_excitation.rates(t)
            x, v, a = x + segment.position_excitation.value(t), v + first, a + second
        force = segment.force
        if segment.force_excitation is not None:
            force += segment.force_excitation.value(t)
        return Desired(x, v, a, force)

    def hold(self) -> tuple[float, float] | None:
        """
        Return the longest interval in which a force is prescribed and x_d rests.

        Returns interval: begin and end [s]; None if there is no such interval
        """
        rests = [
            (begin, begin + segment.duration)
            for begin, segment, before in zip(
                self._begins, self.segments, (self.start, *(s.position for s in self.segments))
            )
            if segment.force == segment.force and segment.position == before
        ]
        return max(rests, key=lambda r: r[1] - r[0], default=None)

    @property
    def desired_force(self) -> float:
        """F_d of the hold [N]; NaN where no force is prescribed."""
        return next((s.force for s in self.segments if s.force == s.force), nan)
