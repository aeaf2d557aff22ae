# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Numbers to raw messages, as little-endian CDR, and the definitions of their types."""

import functools
from functools import lru_cache
from struct import Struct
from typing import Any, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .cdr import NS_PER_S
from ..exceptions import MissingPackageError, RecordingError


class MessageDefinition(NamedTuple):
    """What a recording says about a message type."""

    text: str  # the .msg text followed by those of all types it contains ('ros2msg' encoding)
    type_hash: str  # RIHS01 hash of the type description


@functools.lru_cache(maxsize=None)
def jazzy_typestore() -> Any:
    """
    Load the message types of ROS 2 Jazzy.

    Imported here and not at the top: only writing needs rosbags, and loading takes 0.1 s.

    """
    try:
        from rosbags.typesys import get_typestore, Stores
    except ImportError as error:
        raise MissingPackageError.of('rosbags', 'a recording with message definitions') from error
    return get_typestore(Stores.ROS2_JAZZY)


def fresh_typestore(type_name: str, definition: str) -> Any:
    """Load the message types of ROS 2 Jazzy and one that a recording defines."""
    jazzy_typestore()
    from rosbags.typesys import get_types_from_msg, get_typestore, Stores

    store = get_typestore(Stores.ROS2_JAZZY)
    try:
        if type_name not in store.fielddefs:
            types = get_types_from_msg(definition, type_name)
            store.register({name: fields for name, fields in types.items()
                            if name not in store.fielddefs})
    except Exception as error:  # rosbags has an error of its own for each way to be wrong
        raise RecordingError(
            f'the recording does not define the message type {type_name} readably: {error}; '
            'record it with rosbag2, which writes definitions') from error
    return store


@functools.lru_cache(maxsize=None)
def message_definition(type_name: str) -> MessageDefinition:
    """Look up a message type of ROS 2 Jazzy."""
    store = jazzy_typestore()
    if type_name not in store.fielddefs:
        raise RecordingError(
            f'cannot record message type {type_name!r}: expected a type of the ROS 2 Jazzy '
            "distribution, written like 'geometry_msgs/msg/WrenchStamped'")
    text, _ = store.generate_msgdef(type_name, ros_version=2)
    return MessageDefinition(text, store.hash_rihs01(type_name))


Array = NDArray[np.float64]

_LITTLE_ENDIAN = b'\0\1\0\0'
_FLOAT64 = Struct('<4sd')
_STAMPED = Struct('<4siI')
_PAIR = Struct('<2I')
_TORQUE, _NO_TORQUE = Struct('<3d'), bytes(24)
_ONE = (1).to_bytes(4, 'little')  # length of a sequence of one element


class Vector3StampedEncoder:
    """Write geometry_msgs/msg/Vector3Stamped."""

    def __init__(self, frame_id: str) -> None:
        self._frame = _aligned(_text(frame_id), 8)
        self._pack = Struct(f'<4siI{len(self._frame)}s3d').pack

    def encode(self, stamp_ns: int, x: float, y: float, z: float) -> bytes:
        """Return the message with this stamp [ns] and vector."""
        return self._pack(_LITTLE_ENDIAN, *divmod(stamp_ns, NS_PER_S), self._frame, x, y, z)


class WrenchEncoder:
    """Write geometry_msgs/msg/WrenchStamped."""

    def __init__(self, frame_id: str) -> None:
        self._force = Vector3StampedEncoder(frame_id)

    def encode(self, stamp_ns: int, fx: float, fy: float, fz: float, *torque: float) -> bytes:
        """Return the message with this stamp [ns], force [N] and torque [N m], zero by default."""
        return self._force.encode(stamp_ns, fx, fy, fz) + (
            _TORQUE.pack(*torque) if torque else _NO_TORQUE)


class JointStateEncoder:
    """Write sensor_msgs/msg/JointState of one joint, without effort."""

    def __init__(self, frame_id: str, joint: str, with_velocity: bool) -> None:
        self._frame_id, self._names, self._with_velocity = frame_id, (joint,), with_velocity

    def encode(self, stamp_ns: int, position: float, velocity: float) -> bytes:
        """Return the message with this stamp [ns], position [m] and velocity [m/s]."""
        return encode_arm(stamp_ns, self._names, (position,),
                          (velocity,) if self._with_velocity else (), (), frame_id=self._frame_id)


class TrajectoryEncoder:
    """Write trajectory_msgs/msg/JointTrajectory with one point, due at its stamp, of one joint."""

    def __init__(self, frame_id: str, joint: str) -> None:
        self._frame_id, self._names = frame_id, (joint,)

    def encode(self, stamp_ns: int, *point: float) -> bytes:
        """Return the message with this stamp [ns] and point [m], [m/s], [m/s^2], [N]."""
        return encode_arm(stamp_ns, self._names, *((value,) for value in point), point=True,
                          frame_id=self._frame_id)


def encode_arm(
    stamp_ns: int, names: Sequence[str], *rows: Sequence[float] | Array, point: bool = False,
    frame_id: str = '',
) -> bytes:
    """
    Write sensor_msgs/msg/JointState, or JointTrajectory with one `point`, of all joints.

    rows (n,) or (0,): positions, then each rate and the efforts; empty for what is not published
    """
    data = _head(frame_id, *names) + (_ONE if point else b'')
    for values in rows:
        data = _aligned(data, 4) + len(values).to_bytes(4, 'little')
        if len(values):
            data = _aligned(data, 8) + np.asarray(values, '<f8').tobytes()
    time_from_start = bytes(8 if point else 0)
    return _STAMPED.pack(_LITTLE_ENDIAN, *divmod(stamp_ns, NS_PER_S)) + data + time_from_start


def encode_string(text: str) -> bytes:
    """Return a std_msgs/msg/String with this text."""
    return _LITTLE_ENDIAN + _text(text)


def encode_float64(value: float) -> bytes:
    """Return a std_msgs/msg/Float64 with this value."""
    return _FLOAT64.pack(_LITTLE_ENDIAN, value)


def encode_multi_array(dimensions: Sequence[tuple[str, int]], values: Sequence[float]) -> bytes:
    """Return a std_msgs/msg/Float64MultiArray."""
    layout, stride = len(dimensions).to_bytes(4, 'little'), len(values)
    for label, size in dimensions:
        layout = _aligned(_aligned(layout, 4) + _text(label), 4) + _PAIR.pack(size, stride)
        stride //= size
    head = _aligned(layout + _PAIR.pack(0, len(values)), 8)  # data_offset, length of the data
    return _LITTLE_ENDIAN + head + Struct(f'<{len(values)}d').pack(*values)


@lru_cache(maxsize=64)
def _head(frame_id: str, *joints: str) -> bytes:
    """Write the frame and a sequence of joint names, up to the next sequence."""
    head = _aligned(_text(frame_id), 4) + len(joints).to_bytes(4, 'little')
    for joint in joints:
        head = _aligned(head, 4) + _text(joint)
    return _aligned(head, 4)


def _text(text: str) -> bytes:
    """Write a text with its length."""
    content = text.encode() + b'\0'
    return len(content).to_bytes(4, 'little') + content


def _aligned(data: bytes, alignment: int) -> bytes:
    """Append zeros; `data` begins right after the stamp, which is aligned to 8 bytes."""
    return data + bytes(-len(data) % alignment)
