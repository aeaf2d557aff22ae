# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Raw joint states, of an axis or a whole arm, and trajectories to readings."""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .cdr import CdrCursor, malformed, NS_PER_S, StampedReader
from .plain_decoding import JointReading, TrajectoryReading
from ..exceptions import MessageError


class SeveralJointsDecoder:
    """Read several joints of sensor_msgs/msg/JointState."""

    def __init__(self, joints: Sequence[str]) -> None:
        offsets_of = partial(_joint_state_offsets, joints)
        self._reader = StampedReader('sensor_msgs/msg/JointState', offsets_of)

    def decode(self, raw: bytes) -> tuple[int, tuple[float, ...], tuple[float, ...]]:
        """
        Read one message.

        Returns stamp_ns, positions, velocities: stamp [ns], positions [m] and velocities [m/s] in
        the order of the joints, NaN for velocities that the message does not have
        """
        values = self._reader.read(raw)
        return values[0] * NS_PER_S + values[1], values[3::2], values[4::2]

    def decode_many(self, raws: Sequence[bytes]) -> tuple[Any, Any, Any] | None:
        """
        Read many messages at once.

        Returns stamps_ns, positions, velocities: as of `decode`, one array of shape (N,) a joint;
        None where they must be read one by one
        """
        columns = self._reader.read_many(raws)
        return None if columns is None else (columns[1], columns[2::2], columns[3::2])


class JointStateDecoder:
    """Read one joint of sensor_msgs/msg/JointState."""

    def __init__(self, joint: str = '') -> None:
        offsets_of = partial(_joint_state_offsets, (joint,))
        self._reader = StampedReader('sensor_msgs/msg/JointState', offsets_of)

    def decode(self, raw: bytes) -> JointReading:
        """Read one message."""
        sec, nanosec, _, position, velocity = self._reader.read(raw)
        return JointReading(sec * NS_PER_S + nanosec, position, velocity)


class TrajectoryDecoder:
    """Read one joint of the first point of trajectory_msgs/msg/JointTrajectory."""

    def __init__(self, joint: str = '') -> None:
        offsets_of = partial(_trajectory_offsets, joint)
        self._reader = StampedReader('trajectory_msgs/msg/JointTrajectory', offsets_of)

    def decode(self, raw: bytes) -> TrajectoryReading:
        """Read one message."""
        sec, nanosec, _, *point = self._reader.read(raw)
        return TrajectoryReading(sec * NS_PER_S + nanosec, *point)


def _joint_state_offsets(joints: Sequence[str], cursor: CdrCursor) -> list[int | None]:
    """Find position and velocity of joints: header, name[], position[], velocity[], effort[]."""
    names = cursor.texts()
    position, velocity = cursor.doubles(), cursor.doubles()
    cursor.doubles()  # effort
    cursor.finish()
    offsets: list[int | None] = []
    for joint in joints:
        place = _joint_place(joint, names, len(position))
        if place >= len(position):
            raise MessageError(
                'joint_empty',
                f'joint state of {_listed(names)} has {len(position)} positions, expected one '
                f'for joint number {place + 1}; the publisher must fill position',
            )
        offsets += [position[place], _element(velocity, place)]
    return offsets


def _trajectory_offsets(joint: str, cursor: CdrCursor) -> list[int | None]:
    """
    Find the first point: header, joint_names[], points[].

    A point is positions[], velocities[], accelerations[], effort[], time_from_start (int32 and
    uint32).
    """
    names = cursor.texts()
    points = []
    for _ in range(cursor.length()):
        points.append([cursor.doubles() for _ in range(4)])
        cursor.skip(8, 4)
    cursor.finish()
    first = points[0] if points else [range(0)]
    place = _joint_place(joint, names, len(first[0])) if first[0] else 0
    if place >= len(first[0]):
        raise MessageError(
            'trajectory_empty',
            f'trajectory of {_listed(names)} has {len(points)} points with {len(first[0])} '
            f'positions in the first, expected a position for joint number {place + 1}',
        )
    return [_element(sequence, place) for sequence in first]


def _element(sequence: range, place: int) -> int | None:
    """Return the offset of one element, None where the sequence is too short."""
    return sequence[place] if place < len(sequence) else None


def _joint_place(joint: str, names: Sequence[str], positions: int) -> int:
    """Find the place of a joint among those of a message."""
    if joint:
        if joint in names:
            return list(names).index(joint)
        raise MessageError(
            'joint_unknown',
            f'joint {joint!r} is not in the message, which has {_listed(names)}; '
            'choose one of these with the parameter joint or --joint',
        )
    if max(len(names), positions) > 1:
        raise MessageError(
            'joint_ambiguous',
            f'the message has {max(len(names), positions)} joints: {_listed(names)}; '
            'choose one with the parameter joint or --joint; for an arm set kinematics.* and '
            'contact.normal (--params)',
        )
    return 0


def _listed(names: Sequence[str]) -> str:
    """Write joint names for an error text."""
    return ', '.join(repr(name) for name in names) or 'no joint names'


Array = NDArray[np.float64]


class ArmReading(NamedTuple):
    """One message of sensor_msgs/msg/JointState."""

    stamp_ns: int  # of its header
    names: tuple[str, ...]  # the joints
    # position, velocity, effort: as published: empty where the publisher leaves them out
    position: Array
    velocity: Array
    effort: Array


def decode_arm(raw: bytes) -> ArmReading:
    """Read sensor_msgs/msg/JointState with all joints."""
    try:
        cursor = CdrCursor(raw)
        order = cursor.byte_order
        sec, nanosec = (int(np.frombuffer(raw, order + kind, 1, cursor.skip(4, 4))[0])
                        for kind in ('i4', 'u4'))
        cursor.text()  # frame
        names = tuple(cursor.texts())
        arrays = []
        for _ in range(3):
            places = cursor.doubles()
            arrays.append(np.frombuffer(raw, order + 'f8', len(places), places.start)
                          if len(places) else np.zeros(0))
        cursor.finish()
    except ValueError as error:
        raise malformed(raw, 'sensor_msgs/msg/JointState', error) from error
    return ArmReading(sec * NS_PER_S + nanosec, names, *arrays)


class SomeJointsDecoder:
    """Read those of several joints that a sensor_msgs/msg/JointState has."""

    def __init__(self, joints: Sequence[str]) -> None:
        offsets_of = partial(_present_joint_offsets, joints)
        self._reader = StampedReader('sensor_msgs/msg/JointState', offsets_of)

    def decode(self, raw: bytes) -> tuple[int, tuple[float, ...], tuple[float, ...]]:
        """
        Read one message.

        Returns stamp_ns, positions, velocities: stamp [ns], positions [rad] or [m] and velocities
        in the order of the joints, NaN for what the message does not have
        """
        values = self._reader.read(raw)
        return values[0] * NS_PER_S + values[1], values[3::2], values[4::2]


def _present_joint_offsets(joints: Sequence[str], cursor: CdrCursor) -> list[int | None]:
    """Find position and velocity of the joints that a message has."""
    names = cursor.texts()
    position, velocity = cursor.doubles(), cursor.doubles()
    cursor.doubles()  # effort
    cursor.finish()
    places = {name: place for place, name in enumerate(names)}
    if places.keys().isdisjoint(joints):
        raise MessageError(
            'joint_unknown',
            f'none of the joints {", ".join(joints)} is in the message, which has '
            f'{", ".join(names) or "no joint names"}; check kinematics.base, kinematics.tip and '
            'the topic',
        )
    offsets: list[int | None] = []
    for joint in joints:
        place = places.get(joint, len(position))
        for values in (position, velocity):
            offsets.append(values[place] if place < len(values) else None)
    return offsets
