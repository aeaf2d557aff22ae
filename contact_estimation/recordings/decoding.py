# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Raw messages to plain numbers, independent of any message package."""

from functools import partial
from operator import attrgetter
from struct import unpack_from
from typing import Any, Callable, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .cdr import CdrCursor, NS_PER_S, StampedReader, whole
from ..exceptions import MessageError

Array = NDArray[np.float64]

FLOAT64_TYPE = 'std_msgs/msg/Float64'
STRING_TYPE = 'std_msgs/msg/String'
DIAGNOSTICS_TYPE = 'diagnostic_msgs/msg/DiagnosticArray'
_WRENCH_TYPE = 'geometry_msgs/msg/WrenchStamped'
_JOINTS_TYPE = 'sensor_msgs/msg/JointState'


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


class ArmReading(NamedTuple):
    """One message of sensor_msgs/msg/JointState."""

    stamp_ns: int  # of its header
    names: tuple[str, ...]  # the joints
    # position, velocity, effort: as published: empty where the publisher leaves them out
    position: Array
    velocity: Array
    effort: Array


class DiagnosticReading(NamedTuple):
    """One status of a diagnostic message."""

    level: int  # 0 for OK, 1 for WARN, 2 for ERROR, 3 for STALE
    name: str  # of the component
    message: str  # its state in a sentence
    values: dict[str, str]  # by key


FORCE_OF_AXIS: dict[str, Callable[[WrenchReading], float]] = {
    axis: attrgetter(f'force_{axis}') for axis in 'xyz'}
"""The force along an axis of the wrench's frame."""


def _numbers(count: int, wanted: int | None, cursor: CdrCursor) -> Sequence[int]:
    """Find the first of the numbers that follow the header."""
    places = cursor.doubles(count)[:wanted]
    cursor.finish()
    return places


class WrenchDecoder(StampedReader):
    """Read the force of geometry_msgs/msg/WrenchStamped."""

    def __init__(self) -> None:
        super().__init__(_WRENCH_TYPE, partial(_numbers, 6, 3))
        self.frame_id = ''

    def decode(self, raw: bytes) -> WrenchReading:
        """Read one message."""
        sec, nanosec, self.frame_id, x, y, z = self.read(raw)
        return WrenchReading(sec * NS_PER_S + nanosec, self.frame_id, x, y, z)

    def decode_many(self, raws: Sequence[bytes]) -> tuple[Any, ...] | None:
        """
        Read many messages of one frame at once.

        Returns stamps_ns, x, y, z (N,): stamps [ns] and forces [N]; None where they must be read
        one by one
        """
        columns = self.read_many(raws)
        if columns is None:
            return None
        self.frame_id = columns[0]
        return columns[1:]


class ForceTorqueDecoder(StampedReader):
    """Read force and torque of geometry_msgs/msg/WrenchStamped."""

    def __init__(self) -> None:
        super().__init__(_WRENCH_TYPE, partial(_numbers, 6, None))
        self.frame_id = ''

    def decode(self, raw: bytes) -> tuple[int, tuple[float, ...]]:
        """
        Read one message.

        Returns stamp_ns, wrench: stamp [ns]; force [N] and torque [N m] along x, y and z
        """
        sec, nanosec, self.frame_id, *wrench = self.read(raw)
        return sec * NS_PER_S + nanosec, tuple(wrench)


class Vector3StampedDecoder(StampedReader):
    """Read geometry_msgs/msg/Vector3Stamped."""

    def __init__(self) -> None:
        super().__init__('geometry_msgs/msg/Vector3Stamped', partial(_numbers, 3, None))

    def decode(self, raw: bytes) -> tuple[int, float, float, float]:
        """Read one message; returns stamp_ns, x, y, z: stamp [ns] and vector."""
        sec, nanosec, _, x, y, z = self.read(raw)
        return sec * NS_PER_S + nanosec, x, y, z


class JointStateDecoder(StampedReader):
    """Read one joint of sensor_msgs/msg/JointState."""

    def __init__(self, joint: str = '') -> None:
        super().__init__(_JOINTS_TYPE, partial(_joint_state_offsets, (joint,), True))

    def decode(self, raw: bytes) -> JointReading:
        """Read one message."""
        sec, nanosec, _, position, velocity = self.read(raw)
        return JointReading(sec * NS_PER_S + nanosec, position, velocity)


class JointsDecoder(StampedReader):
    """Read several joints of sensor_msgs/msg/JointState: `every` one, or those that it has."""

    def __init__(self, joints: Sequence[str], every: bool = True) -> None:
        super().__init__(_JOINTS_TYPE, partial(_joint_state_offsets, joints, every))

    def decode(self, raw: bytes) -> tuple[int, tuple[float, ...], tuple[float, ...]]:
        """
        Read one message.

        Returns stamp_ns, positions, velocities: stamp [ns], positions [m] or [rad] and velocities
        in the order of the joints, NaN for what the message does not have
        """
        values = self.read(raw)
        return values[0] * NS_PER_S + values[1], values[3::2], values[4::2]

    def decode_many(self, raws: Sequence[bytes]) -> tuple[Any, Any, Any] | None:
        """
        Read many messages at once.

        Returns stamps_ns, positions, velocities: as of `decode`, one array of shape (N,) a joint;
        None where they must be read one by one
        """
        columns = self.read_many(raws)
        return None if columns is None else (columns[1], columns[2::2], columns[3::2])


class TrajectoryDecoder(StampedReader):
    """Read one joint of the first point of trajectory_msgs/msg/JointTrajectory."""

    def __init__(self, joint: str = '') -> None:
        super().__init__('trajectory_msgs/msg/JointTrajectory',
                         partial(_trajectory_offsets, joint))

    def decode(self, raw: bytes) -> TrajectoryReading:
        """Read one message."""
        sec, nanosec, _, *point = self.read(raw)
        return TrajectoryReading(sec * NS_PER_S + nanosec, *point)


def _joint_state_offsets(
    joints: Sequence[str], every: bool, cursor: CdrCursor
) -> list[int | None]:
    """Find position and velocity of joints: header, name[], position[], velocity[], effort[]."""
    names = cursor.texts()
    position, velocity = cursor.doubles(), cursor.doubles()
    cursor.doubles()  # effort
    cursor.finish()
    if not every and not set(joints) & set(names):
        raise MessageError(
            'joint_unknown',
            f'none of the joints {", ".join(joints)} is in the message, which has '
            f'{", ".join(names) or "no joint names"}; check kinematics.base, kinematics.tip and '
            'the topic',
        )
    offsets: list[int | None] = []
    for joint in joints:
        place = (_joint_place(joint, names, len(position)) if every or joint in names
                 else len(position))
        if every and place >= len(position):
            raise MessageError(
                'joint_empty',
                f'joint state of {_listed(names)} has {len(position)} positions, expected one '
                f'for joint number {place + 1}; the publisher must fill position',
            )
        offsets += [_element(position, place), _element(velocity, place)]
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


def decode_arm(raw: bytes) -> ArmReading:
    """Read sensor_msgs/msg/JointState with all joints."""
    def read(cursor: CdrCursor) -> ArmReading:
        sec, nanosec = unpack_from(cursor.byte_order + 'iI', raw, cursor.skip(8, 4))
        cursor.text()  # frame
        names = tuple(cursor.texts())
        arrays = [np.frombuffer(raw, cursor.byte_order + 'f8', len(places), places.start)
                  if len(places) else np.zeros(0)
                  for places in (cursor.doubles() for _ in range(3))]
        return ArmReading(sec * NS_PER_S + nanosec, names, *arrays)

    return whole(raw, _JOINTS_TYPE, read)


def decode_float64(raw: bytes) -> float:
    """Read std_msgs/msg/Float64."""
    def read(cursor: CdrCursor) -> float:
        return float(unpack_from(cursor.byte_order + 'd', raw, *cursor.doubles(1))[0])

    return whole(raw, FLOAT64_TYPE, read)


def decode_string(raw: bytes) -> str:
    """Read std_msgs/msg/String."""
    return whole(raw, STRING_TYPE, CdrCursor.text)


def decode_diagnostics(raw: bytes) -> list[DiagnosticReading]:
    """Read diagnostic_msgs/msg/DiagnosticArray."""
    def read(cursor: CdrCursor) -> list[DiagnosticReading]:
        cursor.skip(8, 4)  # stamp
        cursor.text()
        return [_status(cursor) for _ in range(cursor.length())]

    return whole(raw, DIAGNOSTICS_TYPE, read)


def _status(cursor: CdrCursor) -> DiagnosticReading:
    level = cursor.raw[cursor.skip(1)]
    name, message, _ = cursor.text(), cursor.text(), cursor.text()  # the last is the hardware
    values = {}
    for _ in range(cursor.length()):
        key = cursor.text()
        values[key] = cursor.text()
    return DiagnosticReading(level, name, message, values)
