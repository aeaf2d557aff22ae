# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Raw wrenches and vectors to readings."""

from __future__ import annotations

from typing import Any, Sequence

from .cdr import CdrCursor, NS_PER_S, StampedReader
from .readings import WrenchReading


class WrenchDecoder:
    """Read geometry_msgs/msg/WrenchStamped."""

    def __init__(self) -> None:
        self.frame_id = ''
        self._reader = StampedReader('geometry_msgs/msg/WrenchStamped', _wrench_offsets)

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
        self._reader = StampedReader('geometry_msgs/msg/WrenchStamped', _force_torque_offsets)

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
        self._reader = StampedReader('geometry_msgs/msg/Vector3Stamped', _vector_offsets)

    def decode(self, raw: bytes) -> tuple[int, float, float, float]:
        """
        Read one message.

        Returns stamp_ns, x, y, z: stamp [ns] and vector
        """
        sec, nanosec, _, x, y, z = self._reader.read(raw)
        return sec * NS_PER_S + nanosec, x, y, z


def _wrench_offsets(cursor: CdrCursor) -> Sequence[int]:
    """Find the force: header, force (x, y, z), torque (x, y, z)."""
    force = cursor.doubles(3)
    cursor.doubles(3)  # torque
    cursor.finish()
    return force


def _force_torque_offsets(cursor: CdrCursor) -> Sequence[int]:
    """Find force and torque."""
    wrench = cursor.doubles(6)
    cursor.finish()
    return wrench


def _vector_offsets(cursor: CdrCursor) -> Sequence[int]:
    """Find the vector: header, vector (x, y, z)."""
    vector = cursor.doubles(3)
    cursor.finish()
    return vector
