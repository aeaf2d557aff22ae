# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Transforms of tf: tf2_msgs/msg/TFMessage."""

from __future__ import annotations

from operator import itemgetter
from struct import Struct
from typing import Any, NamedTuple

from .cdr import CdrCursor, malformed, NS_PER_S, padded_format

TRANSFORMS_TYPE = 'tf2_msgs/msg/TFMessage'
_MOST_LAYOUTS = 64  # every publisher of tf may send several selections of frames


class StampedTransform(NamedTuple):
    """Pose of a frame in its parent frame at one instant."""

    stamp_ns: int  # header stamp [ns]
    # parent, child: names of the frames, without leading slash
    parent: str
    child: str
    # origin x, y, z of the child in the parent [m], quaternion x, y, z, w of its axes
    pose: tuple[float, ...]


class TransformsDecoder:
    """Read tf2_msgs/msg/TFMessage."""

    def __init__(self) -> None:
        self._layouts: dict[int, list[_Layout]] = {}  # by size of the message

    def decode(self, raw: bytes) -> list[StampedTransform]:
        """Read one message."""
        for layout in self._layouts.get(len(raw), ()):
            transforms = layout.read(raw)
            if transforms is not None:
                return transforms
        try:
            layout = _Layout(raw)
        except ValueError as error:
            raise malformed(raw, TRANSFORMS_TYPE, error) from error
        if sum(map(len, self._layouts.values())) >= _MOST_LAYOUTS:
            self._layouts.clear()
        self._layouts.setdefault(len(raw), []).append(layout)
        return layout.read(raw) or []


class _Layout:
    """
    Places of the numbers in all messages with the same frames.

    A message is transforms[]: header (stamp, frame_id), child_frame_id, translation (x, y, z),
    rotation (x, y, z, w).
    """

    def __init__(self, raw: bytes) -> None:
        cursor = CdrCursor(raw)
        wanted: list[tuple[int, str]] = []
        names: list[tuple[str, str]] = []
        for _ in range(cursor.length()):
            stamp = cursor.skip(8, 4)
            names.append((cursor.text().lstrip('/'), cursor.text().lstrip('/')))
            wanted += [(stamp, 'i'), (stamp + 4, 'I'), *((at, 'd') for at in cursor.doubles(7))]
        cursor.finish()
        fixed = [(begin, f'{end - begin}s') for begin, end in cursor.fixed]
        fields = sorted([*wanted, *fixed])
        self._unpack = Struct(cursor.byte_order + padded_format(fields, len(raw))).unpack
        self._fixed = itemgetter(*(fields.index(field) for field in fixed))
        self._expected = self._fixed(self._unpack(raw))
        places = [fields.index(field) for field in wanted]
        self._frames: list[tuple[str, str, Any]] = [
            (*pair, itemgetter(*places[9 * k:9 * k + 9])) for k, pair in enumerate(names)]

    def read(self, raw: bytes) -> list[StampedTransform] | None:
        """Read a message of the layout's size; None if the layout does not fit."""
        values = self._unpack(raw)
        if self._fixed(values) != self._expected:
            return None
        found = []
        for parent, child, pick in self._frames:
            sec, nanosec, *pose = pick(values)
            found.append(StampedTransform(sec * NS_PER_S + nanosec, parent, child, tuple(pose)))
        return found
