# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Messages are written as rosbags and rclpy write them, and read back whatever their structure."""

from itertools import product
import math
from typing import Any, Callable

from contact_estimation.exceptions import MessageError
from contact_estimation.recordings.decoding import (
    decode_float64, decode_string, JointsDecoder, JointStateDecoder, TrajectoryDecoder,
    WrenchDecoder)
from contact_estimation.recordings.encoding import (
    encode_float64, encode_multi_array, encode_string, JointStateEncoder, TrajectoryEncoder,
    Vector3StampedEncoder, WrenchEncoder)
import numpy as np
import pytest
from reference_messages import (
    deserialized, FLOAT64, joint_state_bytes, JOINTS, new, serialized, STRING, TRAJECTORY,
    trajectory_bytes, vector_bytes, WRENCH, wrench_bytes)

FRAMES = ['abcdefghi'[:n] for n in range(10)]
NAMES = ['x', 'xyz', 'x_axis', 'contact_x']
STAMP_NS = 1_750_000_000_123_456_789
HEAD: Any = {'stamp_ns': STAMP_NS}


FIELDS = 'positions', 'velocities', 'accelerations', 'effort'
VALUES = 1.0, -math.inf, 5e-324
NUMBERS = 1.0, 2.0, 3.0, math.nan
MADE: dict[str, tuple[Callable[[str, str], bytes], Callable[[str, str], bytes]]] = {
    'vector': (
        lambda frame, name: Vector3StampedEncoder(frame).encode(STAMP_NS, *VALUES),
        lambda frame, name: vector_bytes(VALUES, frame_id=frame, **HEAD)),
    'wrench': (
        lambda frame, name: WrenchEncoder(frame).encode(STAMP_NS, 1.0, -2.0, 3.0),
        lambda frame, name: wrench_bytes((1.0, -2.0, 3.0), frame_id=frame, **HEAD)),
    'joint state': (
        lambda frame, name: JointStateEncoder(frame, name, True).encode(STAMP_NS, 0.25, -0.5),
        lambda frame, name: joint_state_bytes([name], [0.25], [-0.5], frame_id=frame, **HEAD)),
    'position': (
        lambda frame, name: JointStateEncoder(frame, name, False).encode(STAMP_NS, 0.25, -0.5),
        lambda frame, name: joint_state_bytes([name], [0.25], frame_id=frame, **HEAD)),
    'trajectory': (
        lambda frame, name: TrajectoryEncoder(frame, name).encode(STAMP_NS, *NUMBERS),
        lambda frame, name: trajectory_bytes(
            [name], [{field: [x] for field, x in zip(FIELDS, NUMBERS)}], frame_id=frame, **HEAD)),
}


@pytest.mark.parametrize('own, of_rosbags', MADE.values(), ids=MADE)
def test_messages_have_the_bytes_of_rosbags(
    own: Callable[[str, str], bytes], of_rosbags: Callable[[str, str], bytes]
) -> None:
    for frame_id, name in product(FRAMES, NAMES):
        raw = own(frame_id, name)
        assert raw == of_rosbags(frame_id, name) and type(raw) is bytes, (frame_id, name)


@pytest.mark.parametrize('text', ['', 'a', 'frozen: weak excitation, ε'])
def test_string_has_the_bytes_of_rosbags(text: str) -> None:
    assert encode_string(text) == serialized(new('String', text), STRING)
    assert decode_string(encode_string(text)) == text


@pytest.mark.parametrize('value', [0.0, -1.5, math.inf, math.nan])
def test_number_has_the_bytes_of_rosbags(value: float) -> None:
    assert encode_float64(value) == serialized(new('Float64', value), FLOAT64)
    assert repr(decode_float64(encode_float64(value))) == repr(value)


def test_array_has_the_bytes_of_rosbags() -> None:
    for label in FRAMES:
        values, dimension = [float(k) for k in range(6)], 'MultiArrayDimension'
        dimensions = [new(dimension, label, 2, 6), new(dimension, 'b', 3, 3)]
        layout = new('MultiArrayLayout', dimensions, 0)
        message = new('Float64MultiArray', layout, np.array(values))
        expected = serialized(message, 'std_msgs/msg/Float64MultiArray')
        assert encode_multi_array([(label, 2), ('b', 3)], values) == expected, label


Foreign = Callable[[bytes, str], bytes]


def of_rosbags(raw: bytes, type_name: str) -> bytes:
    """Leave the message as it is."""
    return raw


def of_rclpy(raw: bytes, type_name: str) -> bytes:
    """Let rclpy write the message again: garbage in alignment bytes and behind the last field."""
    serialization = pytest.importorskip('rclpy.serialization')
    package, _, name = type_name.split('/')
    message_type = getattr(pytest.importorskip(f'{package}.msg'), name)
    message = serialization.deserialize_message(raw, message_type)
    return bytes(serialization.serialize_message(message))


@pytest.fixture(params=[of_rosbags, of_rclpy])
def foreign(request: Any) -> Any:
    return request.param


def same(one: Any, other: Any) -> bool:
    return bool(one == other or (math.isnan(one) and math.isnan(other)))


def test_wrench_is_read_for_every_length_of_the_frame(foreign: Foreign) -> None:
    for frame_id in [*FRAMES, 'tööl', 'c' * 300]:
        rng = np.random.default_rng(1)
        decoder = WrenchDecoder()
        for _ in range(5):
            force, torque = rng.normal(size=3).tolist(), rng.normal(size=3).tolist()
            stamp_ns = int(rng.integers(2**31)) * 10**9 + int(rng.integers(10**9))
            raw = wrench_bytes(force, torque, stamp_ns=stamp_ns, frame_id=frame_id)
            reading = decoder.decode(foreign(raw, WRENCH))
            assert reading == (stamp_ns, frame_id, *force), frame_id
            assert (type(reading.stamp_ns), type(reading.force_x)) == (int, float), frame_id


def test_joint_states_of_every_structure_agree_with_rosbags(foreign: Foreign) -> None:
    for frame_length in range(10):
        rng = np.random.default_rng(frame_length)
        for count, name_length, with_velocity, with_effort in product(
            (1, 2, 3), (1, 4, 6), (True, False), (True, False)
        ):
            names = [str(k) * name_length for k in range(count)]
            filled = (True, with_velocity, with_effort)
            arrays = [rng.normal(size=count * there).tolist() for there in filled]
            position, velocity, effort = arrays
            raw = joint_state_bytes(
                names, position, velocity, effort, stamp_ns=7, frame_id='f' * frame_length)
            message = deserialized(raw, JOINTS)
            for place, name in enumerate(names):
                reading = JointStateDecoder(name).decode(foreign(raw, JOINTS))
                assert reading[:2] == (7, message.position[place]), frame_length
                expected = message.velocity[place] if with_velocity else math.nan
                assert same(reading.velocity, expected), frame_length


def test_trajectories_of_every_structure_agree_with_rosbags(foreign: Foreign) -> None:
    for frame_length in range(10):
        rng = np.random.default_rng(frame_length)
        for joints, points, filled in product((1, 2), (1, 3), product((True, False), repeat=3)):
            names = ['j' * (frame_length + k) for k in range(1, joints + 1)]
            made = [
                {field: rng.normal(size=joints * present).tolist()
                 for field, present in zip(FIELDS, (True, *filled))}
                for _ in range(points)]
            raw = trajectory_bytes(names, made, stamp_ns=7, frame_id='f' * frame_length)
            reading = TrajectoryDecoder(names[-1]).decode(foreign(raw, TRAJECTORY))
            expected = [made[0][f][-1] if made[0][f] else math.nan for f in FIELDS]
            assert reading.stamp_ns == 7, frame_length
            assert all(map(same, reading[1:], expected)), frame_length


def test_big_endian_is_read_alone_and_in_batches() -> None:
    raw = wrench_bytes((5, 0, 0), stamp_ns=3_000_000_004, frame_id='tool', little_endian=False)
    decoder = WrenchDecoder()
    assert decoder.decode(raw) == decoder.decode(raw) == (3_000_000_004, 'tool', 5.0, 0.0, 0.0)
    columns: Any = decoder.decode_many([raw, raw])
    assert [column.tolist() for column in columns] == [[3_000_000_004] * 2, [5, 5], [0, 0], [0, 0]]


def flat(values: Any) -> list[Any]:
    """Return the numbers or columns of a reading, of nested ones too."""
    return [one for value in values if not isinstance(value, str)
            for one in (value if isinstance(value, tuple) else (value,))]


@pytest.mark.parametrize('make, decoder', [
    (lambda k: wrench_bytes((k, 2 * k, 3 * k), stamp_ns=k, frame_id='tool'), WrenchDecoder()),
    (lambda k: joint_state_bytes(['x'], [k], [2 * k], stamp_ns=k), JointsDecoder([''])),
    (lambda k: joint_state_bytes(['x'], [k], stamp_ns=k), JointsDecoder(['x']))])
def test_batches_equal_single_messages(make: Any, decoder: Any) -> None:
    raws = [make(k * 10**8) for k in range(50)]
    columns = flat(decoder.decode_many(raws))
    single = [flat(decoder.decode(raw)) for raw in raws]
    np.testing.assert_array_equal(np.array(columns), np.transpose(single))
    assert columns[0].dtype == np.int64


@pytest.mark.parametrize('decoder, raw, reason', [
    (JointStateDecoder(''), joint_state_bytes(['x'], []), 'joint_empty'),
    (JointStateDecoder(''), joint_state_bytes(['x', 'y'], [1.0, 2.0]), 'joint_ambiguous'),
    (JointStateDecoder('z'), joint_state_bytes(['x', 'y'], [1.0, 2.0]), 'joint_unknown'),
    (JointStateDecoder('y'), joint_state_bytes(['x', 'y'], [1.0]), 'joint_empty'),
    (TrajectoryDecoder(''), trajectory_bytes(['x'], []), 'trajectory_empty'),
    (TrajectoryDecoder(''), trajectory_bytes(['x'], [{'velocities': [1.0]}]), 'trajectory_empty'),
    (TrajectoryDecoder(''), trajectory_bytes(['x', 'y'], [{'positions': [1.0, 2.0]}]),
     'joint_ambiguous'),
    (TrajectoryDecoder('z'), trajectory_bytes(['x', 'y'], [{'positions': [1.0, 2.0]}]),
     'joint_unknown'),
    (TrajectoryDecoder('y'), trajectory_bytes(['x', 'y'], [{'positions': [1.0]}]),
     'trajectory_empty')])
def test_trouble_with_joints_has_the_same_reason_each_time(
    decoder: Any, raw: bytes, reason: str
) -> None:
    for _ in range(3):
        with pytest.raises(MessageError) as caught:
            decoder.decode(raw)
        assert caught.value.reason == reason


@pytest.mark.parametrize('decoder, good', [
    (WrenchDecoder(), wrench_bytes((1, 2, 3), frame_id='tool0')),
    (JointStateDecoder(), joint_state_bytes(['x'], [1.0], [2.0], [3.0])),
    (TrajectoryDecoder(), trajectory_bytes(['x'], [{'positions': [1.0]}]))])
def test_message_cut_anywhere_is_malformed(decoder: Any, good: bytes) -> None:
    expected = decoder.decode(good)
    for size in range(len(good)):
        with pytest.raises(MessageError, match='bytes are not a .*/msg/') as caught:
            decoder.decode(good[:size])
        assert caught.value.reason == 'malformed'
    assert str(decoder.decode(good)) == str(expected)
