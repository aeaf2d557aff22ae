# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Joint states that come in several messages, merged into one motion of all joints."""

from collections import deque
from math import pi
from typing import Sequence

from .stamp_screen import BEFORE_ANY

_MOST_KEPT = 10_000  # of a source while another is silent

Row = tuple[int, tuple[float, ...]]
"""Stamp [ns] and numbers."""


class JointMerger:
    """
    Merge messages with some joints each into motions of all joints.

    Messages with the same joints form a source. A motion is given at the newest stamp that every
    source has reached; sources that have gone further are interpolated to it. A message that has
    all joints is passed on as it is.
    """

    def __init__(self, continuous: Sequence[bool]) -> None:
        self._count = len(continuous)
        self._turning = [place for place, turns in enumerate(continuous) if turns]
        self._last = [0.0] * self._count
        self._sources: dict[tuple[int, ...], deque[Row]] = {}
        self._given_ns = BEFORE_ANY

    def add(
        self, stamp_ns: int, positions: Sequence[float], velocities: Sequence[float]
    ) -> Row | None:
        """
        Add a message.

        stamp_ns: its stamp [ns]
        positions, velocities: of all joints [rad], [rad/s] or [m], [m/s]; NaN where the message
        has none
        """
        places = tuple([k for k, value in enumerate(positions) if value == value])
        if self._turning:
            positions = self._unwrapped(positions)
        if len(places) == self._count:
            self._sources.clear()
            return stamp_ns, (*positions, *velocities)
        values = (*(positions[k] for k in places), *(velocities[k] for k in places))
        rows = self._sources.setdefault(places, deque(maxlen=_MOST_KEPT))
        if rows and stamp_ns <= rows[-1][0]:  # the clock jumped back, or a duplicate
            rows.clear()
            self._given_ns = BEFORE_ANY
        rows.append((stamp_ns, values))
        return self._merged()

    @property
    def missing(self) -> list[int]:
        """Places of the joints that no message has had."""
        seen = {place for places in self._sources for place in places}
        return [place for place in range(self._count) if place not in seen]

    def _merged(self) -> Row | None:
        if self.missing:
            return None
        stamp_ns = min(rows[-1][0] for rows in self._sources.values())
        if stamp_ns <= self._given_ns:
            return None
        motion = [0.0] * (2 * self._count)
        for places, rows in self._sources.items():
            values = row_at(rows, stamp_ns)
            if values is None:
                return None
            for number, place in enumerate(places):
                motion[place] = values[number]
                motion[place + self._count] = values[number + len(places)]
        self._given_ns = stamp_ns
        return stamp_ns, tuple(motion)

    def _unwrapped(self, positions: Sequence[float]) -> Sequence[float]:
        unwrapped = list(positions)
        for place in self._turning:
            angle = unwrapped[place]
            if abs(angle) < 1e6:  # also false for NaN
                angle += 2.0 * pi * round((self._last[place] - angle) / (2.0 * pi))
                unwrapped[place] = self._last[place] = angle
        return unwrapped


def row_at(rows: deque[Row], stamp_ns: int) -> tuple[float, ...] | None:
    """Interpolate to a stamp that the last row has reached; None before the first row."""
    while len(rows) > 1 and rows[1][0] <= stamp_ns:
        rows.popleft()
    first_ns, first = rows[0]
    if first_ns == stamp_ns:
        return first
    if first_ns > stamp_ns:
        return None
    second_ns, second = rows[1]
    share = (stamp_ns - first_ns) / (second_ns - first_ns)
    return tuple([a + share * (b - a) for a, b in zip(first, second)])
