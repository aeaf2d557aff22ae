# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Stamped poses of several frames of tf, merged into one motion of all of them."""

from __future__ import annotations

from collections import deque
from typing import Iterable, Sequence

from .frame_tree import usable
from ..recordings.transforms import StampedTransform
from ..signals.stamp_screen import BEFORE_ANY

Row = tuple[int, tuple[float, ...]]

NUMBERS = 7  # of a pose
_MOST_KEPT = 10_000  # of a frame while another is silent


class MovingFrames:
    """
    Merge transforms that come in several messages into rows of all poses at one stamp.

    A row is given at every stamp of any of the frames, once all have reached it; those that have
    no pose at that stamp are interpolated. The rows do not depend on the order in which messages
    of different publishers come.

    The sign of each quaternion is that of the one before it, so that numbers may be interpolated;
    `TransformModel` takes them to unit length again.

    frames: the child frames, in the order of the rows
    time_jump_s: A transform older than the last by more than this is a backward clock jump [s]
    """

    def __init__(self, frames: Sequence[str], time_jump_s: float) -> None:
        self._rows: dict[str, deque[Row]] = {
            frame: deque(maxlen=_MOST_KEPT) for frame in frames}
        self._jump_ns = int(time_jump_s * 1e9)
        self._given_ns = BEFORE_ANY

    @property
    def missing(self) -> list[str]:
        """Return the frames of which no pose has come."""
        return [frame for frame, rows in self._rows.items() if not rows]

    def add(self, transforms: Iterable[StampedTransform]) -> list[Row]:
        """
        Add the transforms of a message.

        Returns rows: stamp [ns], and 7 numbers of each frame
        """
        added = False
        for stamp_ns, _, child, pose in transforms:
            rows = self._rows.get(child)
            if rows is None or not usable(pose):
                continue
            if rows and stamp_ns <= rows[-1][0]:
                if stamp_ns >= rows[-1][0] - self._jump_ns:
                    continue  # a repetition, or out of order
                self._restart()
            rows.append((stamp_ns, _of_same_sign(pose, rows[-1][1]) if rows else pose))
            added = True
        return self._merged() if added else []

    def _restart(self) -> None:
        for rows in self._rows.values():
            rows.clear()
        self._given_ns = BEFORE_ANY

    def _merged(self) -> list[Row]:
        every = list(self._rows.values())
        if not all(every):
            return []
        begin = max(self._given_ns + 1, max(rows[0][0] for rows in every))
        reach = min(rows[-1][0] for rows in every)
        stamps = sorted({row[0] for rows in every for row in rows if begin <= row[0] <= reach})
        if stamps:
            self._given_ns = stamps[-1]
        return [(stamp, sum((_at(rows, stamp) for rows in every), ())) for stamp in stamps]


def _of_same_sign(pose: tuple[float, ...], before: tuple[float, ...]) -> tuple[float, ...]:
    """Return the pose with that of both quaternions of its orientation which is nearer."""
    a, b, c, d = pose[3:]
    if a * before[3] + b * before[4] + c * before[5] + d * before[6] >= 0.0:
        return pose
    return (*pose[:3], -a, -b, -c, -d)


def _at(rows: deque[Row], stamp_ns: int) -> tuple[float, ...]:
    """Interpolate to a stamp between the first and the last row; older rows are dropped."""
    while len(rows) > 1 and rows[1][0] <= stamp_ns:
        rows.popleft()
    first_ns, first = rows[0]
    if first_ns == stamp_ns:
        return first
    second_ns, second = rows[1]
    share = (stamp_ns - first_ns) / (second_ns - first_ns)
    return tuple([a + share * (b - a) for a, b in zip(first, second)])
