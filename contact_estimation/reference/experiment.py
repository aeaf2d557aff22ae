# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Experiments: what the robot is asked to do over time."""

from __future__ import annotations

import bisect
from dataclasses import dataclass
from math import nan

from .excitation import Excitation
from .quintic import quintic
from .setpoints import Desired


@dataclass(frozen=True)
class Segment:
    """
    A quintic to a position, with what is superposed meanwhile.

    Attributes
    ----------
    duration : float
        Time it takes [s], > 0.
    position : float
        Where it ends [m]; the same as before holds still.
    force : float
        F_d [N], positive while pressing; NaN where no force is wanted.
    force_excitation, position_excitation : Excitation or None
        Added to F_d [N] and to x_d [m], of the time since the start of the experiment.

    """

    duration: float
    position: float
    force: float = nan
    force_excitation: Excitation | None = None
    position_excitation: Excitation | None = None


class Experiment:
    """
    A sequence of segments.

    Parameters
    ----------
    name : str
        For people.
    start : float
        Position before the first segment [m].
    segments : sequence of Segment
        One after the other.

    """

    def __init__(self, name: str, start: float, segments: tuple[Segment, ...]) -> None:
        self.name, self.start, self.segments = name, start, segments
        self._repeats = False
        self._begins = [0.0]
        for segment in segments:
            self._begins.append(self._begins[-1] + segment.duration)

    @property
    def duration(self) -> float:
        """Length of the whole [s]."""
        return self._begins[-1]

    def cyclic(self) -> 'Experiment':
        """
        Close the experiment to a cycle that plays for ever.

        Returns
        -------
        experiment : Experiment
            The same segments, with a way back to the start where they end elsewhere: a jump of
            x_d would be an impact.

        """
        segments = self.segments
        if segments[-1].position != self.start:
            segments = (*segments, Segment(segments[0].duration, self.start))
        cycle = Experiment(self.name, self.start, segments)
        cycle._repeats = True
        return cycle

    def desired(self, t: float) -> Desired:
        """
        Evaluate the experiment.

        Parameters
        ----------
        t : float
            Time since its start [s]; before and after, it rests, unless it is a cycle.

        Returns
        -------
        desired : Desired
            What is wanted then.

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
        Find the longest stretch in which force is wanted and x_d rests.

        Returns
        -------
        interval : tuple of float or None
            Begin and end [s]; None where there is none.

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
    def wanted_force(self) -> float:
        """F_d of the hold [N]; NaN where no force is wanted."""
        return next((s.force for s in self.segments if s.force == s.force), nan)
