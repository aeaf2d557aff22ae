# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Raw wrenches, vectors, numbers, texts and diagnostics to plain readings."""

from __future__ import annotations

from struct import unpack_from
from typing import Any, Callable, NamedTuple, Sequence, TypeVar

from .cdr import CdrCursor, malformed, NS_PER_S, StampedReader
from .readings import WrenchReading

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
