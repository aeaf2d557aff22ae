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

"""Raw messages to readings."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from .codec import Codec
from .fields import Field, FLOAT64, INT32, scalars, sequences, stamp_fields, UINT32
from .learning import NumberReader, Plan
from .readings import JointReading, TrajectoryReading, WrenchReading
from ..exceptions import MessageError

WRENCH_TYPE = 'geometry_msgs/msg/WrenchStamped'
JOINT_STATE_TYPE = 'sensor_msgs/msg/JointState'
VECTOR3_TYPE = 'geometry_msgs/msg/Vector3Stamped'
TRAJECTORY_TYPE = 'trajectory_msgs/msg/JointTrajectory'

_NS_PER_S = 1_000_000_000
_STAMP = tuple(stamp_fields())
_POINT_SEQUENCES = ('positions', 'velocities', 'accelerations', 'effort')


class WrenchDecoder:
    """
    Reads geometry_msgs/msg/WrenchStamped.

    Parameters
    ----------
    codec : Codec
        The message library.

    """

    def __init__(self, codec: Codec) -> None:
        self._reader = NumberReader(codec, WRENCH_TYPE, self._plan)

    def decode(self, raw: bytes) -> WrenchReading:
        """
        Read one message.

        Parameters
        ----------
        raw : bytes
            CDR with its encapsulation header.

        Returns
        -------
        reading : WrenchReading
            Stamp, frame and force.

        Raises
        ------
        MessageError
            With reason 'malformed'.

        """
        sec, nanosec, x, y, z = self._reader.read(raw)
        return WrenchReading(sec * _NS_PER_S + nanosec, self._reader.note, x, y, z)

    @property
    def frame_id(self) -> str:
        """Frame of the message read last."""
        return self._reader.note

    def decode_many(self, raws: Sequence[bytes]) -> tuple[Any, ...] | None:
        """
        Read many messages at once; all have the frame of the first.

        Parameters
        ----------
        raws : sequence of bytes
            Messages, at least one.

        Returns
        -------
        stamps_ns, x, y, z : ndarray, shape (N,), or None
            Stamps [ns] and forces [N]; None where they must be read one by one.

        """
        return _with_stamps(self._reader.read_many(raws))

    @staticmethod
    def _plan(message: Any) -> Plan:
        """List the numbers of a wrench message."""
        axes = dict.fromkeys('xyz', FLOAT64)
        force = scalars(('wrench', 'force'), axes)
        torque = scalars(('wrench', 'torque'), axes)
        return Plan([*_STAMP, *force, *torque], (*_STAMP, *force), message.header.frame_id)


class Vector3StampedDecoder:
    """
    Reads geometry_msgs/msg/Vector3Stamped.

    Parameters
    ----------
    codec : Codec
        The message library.

    """

    def __init__(self, codec: Codec) -> None:
        self._reader = NumberReader(codec, VECTOR3_TYPE, self._plan)

    def decode(self, raw: bytes) -> tuple[int, float, float, float]:
        """
        Read one message.

        Parameters
        ----------
        raw : bytes
            CDR with its encapsulation header.

        Returns
        -------
        stamp_ns, x, y, z : int, float, float, float
            Stamp [ns] and vector.

        Raises
        ------
        MessageError
            With reason 'malformed'.

        """
        sec, nanosec, x, y, z = self._reader.read(raw)
        return sec * _NS_PER_S + nanosec, x, y, z

    @staticmethod
    def _plan(message: Any) -> Plan:
        """List the numbers of a vector message."""
        vector = scalars(('vector',), dict.fromkeys('xyz', FLOAT64))
        return Plan([*_STAMP, *vector], (*_STAMP, *vector), message.header.frame_id)


class JointStateDecoder:
    """
    Reads one joint of sensor_msgs/msg/JointState.

    Parameters
    ----------
    codec : Codec
        The message library.
    joint : str
        Name of the joint; '' is the only joint of the message.

    """

    def __init__(self, codec: Codec, joint: str = '') -> None:
        self._joint = joint
        self._reader = NumberReader(codec, JOINT_STATE_TYPE, self._plan)

    def decode(self, raw: bytes) -> JointReading:
        """
        Read one message.

        Parameters
        ----------
        raw : bytes
            CDR with its encapsulation header.

        Returns
        -------
        reading : JointReading
            Velocity is NaN where the message has none.

        Raises
        ------
        MessageError
            With reason 'malformed', 'joint_empty', 'joint_unknown' or 'joint_ambiguous'.

        """
        sec, nanosec, position, velocity = self._reader.read(raw)
        return JointReading(sec * _NS_PER_S + nanosec, position, velocity)

    def decode_many(self, raws: Sequence[bytes]) -> tuple[Any, ...] | None:
        """
        Read many messages at once.

        Parameters
        ----------
        raws : sequence of bytes
            Messages, at least one.

        Returns
        -------
        stamps_ns, position, velocity : ndarray, shape (N,), or None
            Stamps [ns], positions [m] and velocities [m/s]; None where they must be read one
            by one.

        """
        return _with_stamps(self._reader.read_many(raws))

    def _plan(self, message: Any) -> Plan:
        """List the numbers of a joint state and choose those of the joint."""
        fields = [*_STAMP, *sequences(message, (), ('position', 'velocity', 'effort'))]
        try:
            place = _joint_place(self._joint, message.name, len(message.position))
        except MessageError as trouble:
            return Plan(fields, _STAMP, trouble=trouble)
        chosen = [_element(fields, (), name, place) for name in ('position', 'velocity')]
        if chosen[0] is None:
            return Plan(fields, _STAMP, trouble=MessageError(
                'joint_empty',
                f'joint state of {_names(message.name)} has {len(message.position)} positions, '
                f'expected one for the joint at place {place}; the publisher must fill position',
            ))
        return Plan(fields, (*_STAMP, *chosen))


class TrajectoryDecoder:
    """
    Reads one joint of the first point of trajectory_msgs/msg/JointTrajectory.

    Parameters
    ----------
    codec : Codec
        The message library.
    joint : str
        Name of the joint; '' is the only joint of the message.

    """

    def __init__(self, codec: Codec, joint: str = '') -> None:
        self._joint = joint
        self._reader = NumberReader(codec, TRAJECTORY_TYPE, self._plan)

    def decode(self, raw: bytes) -> TrajectoryReading:
        """
        Read one message.

        Parameters
        ----------
        raw : bytes
            CDR with its encapsulation header.

        Returns
        -------
        reading : TrajectoryReading
            NaN for what the first point does not have.

        Raises
        ------
        MessageError
            With reason 'malformed', 'trajectory_empty', 'joint_unknown' or 'joint_ambiguous'.

        """
        sec, nanosec, position, velocity, acceleration, effort = self._reader.read(raw)
        return TrajectoryReading(
            sec * _NS_PER_S + nanosec, position, velocity, acceleration, effort
        )

    def _plan(self, message: Any) -> Plan:
        """List the numbers of a trajectory and choose those of the joint in the first point."""
        fields = list(_STAMP)
        for number in range(len(message.points)):
            path = ('points', number)
            fields += sequences(message, path, _POINT_SEQUENCES)
            fields += scalars((*path, 'time_from_start'), {'sec': INT32, 'nanosec': UINT32})
        positions = len(message.points[0].positions) if len(message.points) else 0
        if positions == 0:
            return Plan(fields, _STAMP, trouble=MessageError(
                'trajectory_empty',
                f'trajectory of {_names(message.joint_names)} has {len(message.points)} points '
                'and no position in the first, expected one point with a position',
            ))
        try:
            place = _joint_place(self._joint, message.joint_names, positions)
        except MessageError as trouble:
            return Plan(fields, _STAMP, trouble=trouble)
        chosen = [_element(fields, ('points', 0), name, place) for name in _POINT_SEQUENCES]
        if chosen[0] is None:
            return Plan(fields, _STAMP, trouble=MessageError(
                'trajectory_empty',
                f'trajectory of {_names(message.joint_names)} has {positions} positions in its '
                f'first point, expected one for the joint at place {place}',
            ))
        return Plan(fields, (*_STAMP, *chosen))


def _with_stamps(columns: tuple[Any, ...] | None) -> tuple[Any, ...] | None:
    """Put seconds and nanoseconds together."""
    if columns is None:
        return None
    sec, nanosec, *values = columns
    return (sec.astype(np.int64) * _NS_PER_S + nanosec, *values)


def _joint_place(joint: str, names: Sequence[str], positions: int) -> int:
    """Find the place of a joint among those of a message."""
    if joint:
        if joint in names:
            return list(names).index(joint)
        raise MessageError(
            'joint_unknown',
            f'joint {joint!r} is not in the message, which has {_names(names)}; '
            'choose one of these with the parameter joint or --joint',
        )
    if max(len(names), positions) > 1:
        raise MessageError(
            'joint_ambiguous',
            f'the message has {max(len(names), positions)} joints: {_names(names)}; '
            'choose one with the parameter joint or --joint',
        )
    return 0


def _element(
    fields: Sequence[Field], path: tuple[str | int, ...], name: str, place: int
) -> Field | None:
    """Return the field of one element of a sequence, None where the sequence is too short."""
    field = Field(path, name, place, FLOAT64)
    return field if field in fields else None


def _names(names: Sequence[str]) -> str:
    """Write joint names for an error text."""
    return ', '.join(repr(name) for name in names) or 'no joint names'
