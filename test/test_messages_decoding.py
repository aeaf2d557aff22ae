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

"""Decoders read what the message library reads, whatever the structure of the message."""

import importlib
import math
import struct
from typing import Any

from contact_estimation.exceptions import MessageError
from contact_estimation.messages import (
    JointStateDecoder,
    RosbagsCodec,
    TrajectoryDecoder,
    WrenchDecoder,
)
import numpy as np
import pytest

WRENCH = 'geometry_msgs/msg/WrenchStamped'
JOINTS = 'sensor_msgs/msg/JointState'
TRAJECTORY = 'trajectory_msgs/msg/JointTrajectory'
POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'


class RclpyCodec:
    """The codec of a ROS installation."""

    def __init__(self) -> None:
        self.serialization = importlib.import_module('rclpy.serialization')

    def _type(self, type_name: Any) -> Any:
        package, _, name = type_name.split('/')
        return getattr(importlib.import_module(package + '.msg'), name)

    def serialize(self, message: Any, type_name: Any) -> Any:
        return self.serialization.serialize_message(message)

    def deserialize(self, data: Any, type_name: Any) -> Any:
        return self.serialization.deserialize_message(data, self._type(type_name))

    def new(self, type_name: Any) -> Any:
        return self._type(type_name)()

    def floats(self, values: Any) -> Any:
        return list(values)


class CountingCodec(RosbagsCodec):
    """Counts how often the library is asked to read a message."""

    def __init__(self) -> None:
        super().__init__()
        self.reads = 0

    def deserialize(self, data: Any, type_name: Any) -> Any:
        self.reads += 1
        return super().deserialize(data, type_name)


@pytest.fixture(params=['rosbags', 'rclpy'])
def codec(request: Any) -> Any:
    if request.param == 'rosbags':
        return RosbagsCodec()
    pytest.importorskip('rclpy')
    return RclpyCodec()


def stamped(codec: Any, type_name: Any, sec: Any = 0, nanosec: Any = 0, frame_id: Any = '') -> Any:
    message = codec.new(type_name)
    message.header.stamp.sec = sec
    message.header.stamp.nanosec = nanosec
    message.header.frame_id = frame_id
    return message


def wrench_bytes(codec: Any, force: Any, torque: Any = (0.0, 0.0, 0.0), **header: Any) -> Any:
    message = stamped(codec, WRENCH, **header)
    for axis, f, t in zip('xyz', force, torque):
        setattr(message.wrench.force, axis, float(f))
        setattr(message.wrench.torque, axis, float(t))
    return codec.serialize(message, WRENCH)


def joint_bytes(
    codec: Any, names: Any, position: Any, velocity: Any = (), effort: Any = (), **header: Any
) -> Any:
    message = stamped(codec, JOINTS, **header)
    message.name = list(names)
    message.position = codec.floats(position)
    message.velocity = codec.floats(velocity)
    message.effort = codec.floats(effort)
    return codec.serialize(message, JOINTS)


def trajectory_bytes(codec: Any, names: Any, points: Any, **header: Any) -> Any:
    message = stamped(codec, TRAJECTORY, **header)
    message.joint_names = list(names)
    message.points = []
    for number, values in enumerate(points):
        point = codec.new(POINT)
        for name, sequence in values.items():
            setattr(point, name, codec.floats(sequence))
        point.time_from_start.sec = number
        message.points.append(point)
    return codec.serialize(message, TRAJECTORY)


def same(one: Any, other: Any) -> Any:
    return one == other or (math.isnan(one) and math.isnan(other))


@pytest.mark.parametrize('frame_id', ['', 'tool0', 'tööl', 'a' * 7, 'b' * 8, 'c' * 300])
def test_wrench_decoder_reads_random_messages(codec: Any, frame_id: Any) -> None:
    rng = np.random.default_rng(1)
    decoder = WrenchDecoder(codec)
    for _ in range(20):
        force, torque = rng.normal(size=3), rng.normal(size=3)
        sec, nanosec = int(rng.integers(2**31)), int(rng.integers(10**9))
        raw = wrench_bytes(codec, force, torque, sec=sec, nanosec=nanosec, frame_id=frame_id)
        assert decoder.decode(raw) == (sec * 10**9 + nanosec, frame_id, *force)


def test_library_reads_only_the_first_message_of_a_structure() -> None:
    codec = CountingCodec()
    decoder = WrenchDecoder(codec)
    for value in range(10):
        decoder.decode(wrench_bytes(codec, (value, 0, 0), (0, value, 0), sec=value))
    assert codec.reads == 1


def test_alternating_structures_are_all_remembered() -> None:
    codec = CountingCodec()
    decoder = WrenchDecoder(codec)
    for value in range(30):
        frame_id = f'frame_{value % 3}'
        reading = decoder.decode(wrench_bytes(codec, (value, 0, 0), frame_id=frame_id))
        assert (reading.frame_id, reading.force_x) == (frame_id, value)
    assert codec.reads == 3


def test_structures_without_end_are_read_by_the_library() -> None:
    codec = RosbagsCodec()
    decoder = WrenchDecoder(codec)
    for number in range(100):
        for value in (1.0, 2.0):
            raw = wrench_bytes(codec, (value, 0, 0), frame_id=f'{number:03}')
            assert decoder.decode(raw)[1:3] == (f'{number:03}', value)
    assert decoder.decode(wrench_bytes(codec, (7, 0, 0), frame_id='000')).frame_id == '000'


def test_markers_nan_and_infinity_are_ordinary_values(codec: Any) -> None:
    marker = struct.unpack('<d', struct.pack('<II', 0x2A5C3B02, 0x2A5C3B02 ^ 0x6B000000))[0]
    decoder = WrenchDecoder(codec)
    for force in [(marker, marker, marker), (math.nan, math.inf, -math.inf), (0.0, -0.0, 1.0)]:
        raw = wrench_bytes(codec, force, force, sec=0x2A5C3B00, nanosec=0x1563D901)
        for reading in (decoder.decode(raw), WrenchDecoder(codec).decode(raw)):
            assert all(map(same, reading[2:], force))
            assert reading.stamp_ns == 0x2A5C3B00 * 10**9 + 0x1563D901


def test_padding_garbage_does_not_cost_the_fast_path() -> None:
    codec = CountingCodec()
    decoder = WrenchDecoder(codec)
    rng = np.random.default_rng(2)
    for number in range(60):
        raw = bytearray(wrench_bytes(codec, (number, 0, 0), frame_id='tool0'))
        raw[22:28] = rng.bytes(6)  # between the text and the first double
        assert decoder.decode(bytes(raw)).force_x == number
    assert codec.reads < 10


def test_trailing_alignment_bytes_are_tolerated() -> None:
    codec = CountingCodec()
    decoder = JointStateDecoder(codec)
    for number in range(5):
        raw = joint_bytes(codec, ['x'], [number], frame_id='base') + bytes([number] * 3)
        assert decoder.decode(raw).position == number
    assert codec.reads == 1


def test_big_endian_is_read_by_the_library() -> None:
    codec = RosbagsCodec()
    message = stamped(codec, WRENCH, sec=3, nanosec=4, frame_id='tool')
    message.wrench.force.x = 5.0
    raw = bytes(codec._store.serialize_cdr(message, WRENCH, little_endian=False))
    decoder = WrenchDecoder(codec)
    assert decoder.decode(raw) == decoder.decode(raw) == (3000000004, 'tool', 5.0, 0.0, 0.0)


def test_empty_velocity_and_empty_effort_of_equal_length_are_told_apart(codec: Any) -> None:
    with_velocity = joint_bytes(codec, ['x'], [1.0], velocity=[2.0])
    with_effort = joint_bytes(codec, ['x'], [1.0], effort=[3.0])
    decoder = JointStateDecoder(codec)
    for _ in range(3):
        assert decoder.decode(with_velocity) == (0, 1.0, 2.0)
        assert math.isnan(decoder.decode(with_effort).velocity)


def test_chosen_joint_is_read_among_several(codec: Any) -> None:
    rng = np.random.default_rng(3)
    decoder = JointStateDecoder(codec, 'wrist')
    for _ in range(10):
        position, velocity = rng.normal(size=3), rng.normal(size=3)
        raw = joint_bytes(codec, ['base', 'elbow', 'wrist'], position, velocity)
        assert decoder.decode(raw) == (0, position[2], velocity[2])
        raw = joint_bytes(codec, ['wrist', 'elbow', 'bases'], position, velocity)
        assert decoder.decode(raw) == (0, position[0], velocity[0])


@pytest.mark.parametrize('joint, names, position, reason', [
    ('', ['x'], [], 'joint_empty'),
    ('', ['x', 'y'], [1.0, 2.0], 'joint_ambiguous'),
    ('z', ['x', 'y'], [1.0, 2.0], 'joint_unknown'),
    ('y', ['x', 'y'], [1.0], 'joint_empty'),
])
def test_joint_trouble_has_a_reason_each_time(
    codec: Any, joint: Any, names: Any, position: Any, reason: Any
) -> None:
    decoder = JointStateDecoder(codec, joint)
    for _ in range(3):
        with pytest.raises(MessageError) as caught:
            decoder.decode(joint_bytes(codec, names, position))
        assert caught.value.reason == reason


def test_other_publishers_on_the_topic_do_not_cost_the_library() -> None:
    codec = CountingCodec()
    decoder = JointStateDecoder(codec, 'x')
    for value in range(10):
        assert decoder.decode(joint_bytes(codec, ['x'], [value])).position == value
        with pytest.raises(MessageError):
            decoder.decode(joint_bytes(codec, ['gripper'], [value]))
    assert codec.reads == 2


def test_first_point_of_a_trajectory_is_read(codec: Any) -> None:
    points = [
        {'positions': [k, k + 0.1], 'velocities': [k + 0.2, k + 0.3],
         'accelerations': [k + 0.4, k + 0.5], 'effort': [k + 0.6, k + 0.7]}
        for k in (1.0, 2.0, 3.0)
    ]
    raw = trajectory_bytes(codec, ['x', 'y'], points, sec=9, frame_id='base')
    decoder = TrajectoryDecoder(codec, 'y')
    for _ in range(2):
        assert decoder.decode(raw) == (9 * 10**9, 1.1, 1.3, 1.5, 1.7)


def test_missing_derivatives_are_nan(codec: Any) -> None:
    raw = trajectory_bytes(codec, ['x'], [{'positions': [1.0], 'effort': [math.nan]}])
    decoder = TrajectoryDecoder(codec)
    for _ in range(2):
        reading = decoder.decode(raw)
        assert reading.position == 1.0
        assert all(map(math.isnan, reading[2:]))


def test_long_trajectory_is_read() -> None:
    codec = RosbagsCodec()
    points = [{'positions': [float(k)], 'effort': [2.0]} for k in range(1, 500)]
    raw = trajectory_bytes(codec, ['x'], points)
    assert TrajectoryDecoder(codec).decode(raw)[1::3] == (1.0, 2.0)


@pytest.mark.parametrize('joint, names, points, reason', [
    ('', ['x'], [], 'trajectory_empty'),
    ('', ['x'], [{'velocities': [1.0]}], 'trajectory_empty'),
    ('', ['x', 'y'], [{'positions': [1.0, 2.0]}], 'joint_ambiguous'),
    ('z', ['x', 'y'], [{'positions': [1.0, 2.0]}], 'joint_unknown'),
    ('y', ['x', 'y'], [{'positions': [1.0]}], 'trajectory_empty'),
])
def test_trajectory_trouble_has_a_reason(
    codec: Any, joint: Any, names: Any, points: Any, reason: Any
) -> None:
    decoder = TrajectoryDecoder(codec, joint)
    for _ in range(2):
        with pytest.raises(MessageError) as caught:
            decoder.decode(trajectory_bytes(codec, names, points))
        assert caught.value.reason == reason


def test_malformed_bytes_have_a_reason(codec: Any) -> None:
    decoder = WrenchDecoder(codec)
    good = wrench_bytes(codec, (1, 2, 3), frame_id='tool0')
    decoder.decode(good)
    for bad in (b'', b'\x00', good[:4], good[:30], good[:-1], b'\x07\x07' + good[2:]):
        with pytest.raises(MessageError, match='WrenchStamped') as caught:
            decoder.decode(bad)
        assert caught.value.reason == 'malformed'
    assert decoder.decode(good).force_z == 3.0


def test_random_joint_states_agree_with_the_library(codec: Any) -> None:
    rng = np.random.default_rng(4)
    decoder = JointStateDecoder(codec, 'j0')
    for _ in range(300):
        names = [f'j{k}' for k in range(rng.integers(1, 4))]
        arrays = [rng.normal(size=int(rng.integers(0, 2)) * len(names)) for _ in range(3)]
        frame_id = 'f' * int(rng.integers(0, 3))
        raw = joint_bytes(codec, names, *arrays, sec=int(rng.integers(9)), frame_id=frame_id)
        message = codec.deserialize(raw, JOINTS)
        if not len(message.position):
            with pytest.raises(MessageError):
                decoder.decode(raw)
            continue
        velocity = message.velocity[0] if len(message.velocity) else math.nan
        reading = decoder.decode(raw)
        assert reading[:2] == (message.header.stamp.sec * 10**9, message.position[0])
        assert same(reading.velocity, velocity)
