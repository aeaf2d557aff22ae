# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Raw messages, but those of joints, to plain numbers, independent of any message package."""

from __future__ import annotations

from operator import attrgetter, itemgetter
from struct import Struct, unpack_from
from typing import Any, Callable, NamedTuple, Sequence, TypeVar

from .cdr import CdrCursor, malformed, NS_PER_S, padded_format, StampedReader

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


# Named tuples and not frozen dataclasses: these cost a microsecond more to build, and are built a
# thousand times a second.

class WrenchReading(NamedTuple):
    """One force measurement."""

    stamp_ns: int  # header stamp [ns]
    frame_id: str  # frame in which the force is expressed
    # force_x, force_y, force_z: force [N]
    force_x: float
    force_y: float
    force_z: float


class JointReading(NamedTuple):
    """Position and velocity of one joint."""

    stamp_ns: int  # header stamp [ns]
    position: float  # position [m]
    velocity: float  # velocity [m/s], NaN where the message has none


class TrajectoryReading(NamedTuple):
    """First point of a trajectory for one joint."""

    stamp_ns: int  # header stamp [ns]
    position: float  # position [m]
    # velocity, acceleration: its derivatives [m/s], [m/s^2], NaN where the message has none
    velocity: float
    acceleration: float
    effort: float  # force F_r [N], NaN where the message has none


FORCE_OF_AXIS: dict[str, Callable[[WrenchReading], float]] = {
    'x': attrgetter('force_x'),
    'y': attrgetter('force_y'),
    'z': attrgetter('force_z'),
}
"""The force along an axis of the wrench's frame."""


Content = TypeVar('Content')


class WrenchDecoder:
    """Read geometry_msgs/msg/WrenchStamped."""

    def __init__(self) -> None:
        self.frame_id = ''
        self._reader = StampedReader('geometry_msgs/msg/WrenchStamped', _numbers(6, 3))

    def decode(self, raw: bytes) -> WrenchReading:
        """Read one message."""
        sec, nanosec, self.frame_id, x, y, z = self._reader.read(raw)
        return WrenchReading(sec * NS_PER_S + nanosec, self.frame_id, x, y, z)

    def decode_many(self, raws: Sequence[bytes]) -> tuple[Any, ...] | None:
        """
        Read many messages of one frame at once.

        Returns stamps_ns, x, y, z (N,): stamps [ns] and forces [N]; None where they must be read
        one by one
        """
        columns = self._reader.read_many(raws)
        if columns is None:
            return None
        self.frame_id = columns[0]
        return columns[1:]


class ForceTorqueDecoder:
    """Read force and torque of geometry_msgs/msg/WrenchStamped."""

    def __init__(self) -> None:
        self.frame_id = ''
        self._reader = StampedReader('geometry_msgs/msg/WrenchStamped', _numbers(6))

    def decode(self, raw: bytes) -> tuple[int, tuple[float, ...]]:
        """
        Read one message.

        Returns stamp_ns, wrench: stamp [ns]; force [N] and torque [N m] along x, y and z
        """
        sec, nanosec, self.frame_id, *wrench = self._reader.read(raw)
        return sec * NS_PER_S + nanosec, tuple(wrench)


class Vector3StampedDecoder:
    """Read geometry_msgs/msg/Vector3Stamped."""

    def __init__(self) -> None:
        self._reader = StampedReader('geometry_msgs/msg/Vector3Stamped', _numbers(3))

    def decode(self, raw: bytes) -> tuple[int, float, float, float]:
        """Read one message; returns stamp_ns, x, y, z: stamp [ns] and vector."""
        sec, nanosec, _, x, y, z = self._reader.read(raw)
        return sec * NS_PER_S + nanosec, x, y, z


def _numbers(count: int, wanted: int | None = None) -> Callable[[CdrCursor], Sequence[int]]:
    """Return what finds the first of the numbers that follow the header."""
    def offsets(cursor: CdrCursor) -> Sequence[int]:
        places = cursor.doubles(count)[:wanted]
        cursor.finish()
        return places

    return offsets


FLOAT64_TYPE = 'std_msgs/msg/Float64'
STRING_TYPE = 'std_msgs/msg/String'


def decode_float64(raw: bytes) -> float:
    """Read std_msgs/msg/Float64."""
    def read(cursor: CdrCursor) -> float:
        return float(unpack_from(cursor.byte_order + 'd', raw, *cursor.doubles(1))[0])

    return _whole(raw, FLOAT64_TYPE, read)


def decode_string(raw: bytes) -> str:
    """Read std_msgs/msg/String."""
    return _whole(raw, STRING_TYPE, CdrCursor.text)


def _whole(raw: bytes, type_name: str, read: Callable[[CdrCursor], Content]) -> Content:
    """Read a whole message."""
    try:
        cursor = CdrCursor(raw)
        content = read(cursor)
        cursor.finish()
    except ValueError as error:
        raise malformed(raw, type_name, error) from error
    return content


DIAGNOSTICS_TYPE = 'diagnostic_msgs/msg/DiagnosticArray'


class DiagnosticReading(NamedTuple):
    """One status of a diagnostic message."""

    level: int  # 0 for OK, 1 for WARN, 2 for ERROR, 3 for STALE
    name: str  # of the component
    message: str  # its state in a sentence
    values: dict[str, str]  # by key


def decode_diagnostics(raw: bytes) -> list[DiagnosticReading]:
    """Read diagnostic_msgs/msg/DiagnosticArray."""
    def read(cursor: CdrCursor) -> list[DiagnosticReading]:
        cursor.skip(8, 4)  # stamp
        cursor.text()
        return [_status(cursor) for _ in range(cursor.length())]

    return _whole(raw, DIAGNOSTICS_TYPE, read)


def _status(cursor: CdrCursor) -> DiagnosticReading:
    level = cursor.raw[cursor.skip(1)]
    name, message, _ = cursor.text(), cursor.text(), cursor.text()  # the last is the hardware
    values = {}
    for _ in range(cursor.length()):
        key = cursor.text()
        values[key] = cursor.text()
    return DiagnosticReading(level, name, message, values)
