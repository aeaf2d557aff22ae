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

"""Encoders write what the message library writes, and decoders read it back."""

import math
from typing import Any

from contact_estimation.messages import (
    JointStateDecoder,
    JointStateEncoder,
    RosbagsCodec,
    StringEncoder,
    TrajectoryDecoder,
    TrajectoryEncoder,
    Vector3StampedEncoder,
    WrenchDecoder,
    WrenchEncoder,
)
import numpy as np
import pytest

FRAMES = ['', 'tool0', 'base_link', 'a' * 100]
STAMP_NS = 1_750_000_000_123_456_789


def from_rclpy(raw: Any, module: Any, name: Any) -> Any:
    """Let rclpy read a message, skip where there is no ROS installation."""
    serialization = pytest.importorskip('rclpy.serialization')
    message_type = getattr(pytest.importorskip(module), name)
    return serialization.deserialize_message(raw, message_type)


def rclpy_bytes(message: Any, type_name: Any) -> Any:
    """
    Serialise by rclpy, with zeros in the alignment padding.

    Fast CDR leaves whatever was in memory there; rosbags writes zeros.

    """
    serialization = pytest.importorskip('rclpy.serialization')
    codec = RosbagsCodec()
    raw = serialization.serialize_message(message)
    clean = codec.serialize(codec.deserialize(raw, type_name), type_name)
    assert len(raw) == len(clean)
    return clean


@pytest.mark.parametrize('frame_id', FRAMES)
def test_vector_has_the_bytes_of_rclpy(frame_id: Any) -> None:
    encoder = Vector3StampedEncoder(RosbagsCodec(), frame_id)
    for values in np.random.default_rng(1).normal(size=(20, 3)):
        raw = encoder.encode(STAMP_NS, *values)
        message = from_rclpy(raw, 'geometry_msgs.msg', 'Vector3Stamped')
        assert (message.vector.x, message.vector.y, message.vector.z) == tuple(values)
        assert message.header.frame_id == frame_id
        assert raw == rclpy_bytes(message, 'geometry_msgs/msg/Vector3Stamped')


@pytest.mark.parametrize('frame_id', FRAMES)
def test_trajectory_has_the_bytes_of_rclpy(frame_id: Any) -> None:
    encoder = TrajectoryEncoder(RosbagsCodec(), frame_id, 'x_axis')
    for values in np.random.default_rng(2).normal(size=(20, 4)):
        raw = encoder.encode(STAMP_NS, *values)
        message = from_rclpy(raw, 'trajectory_msgs.msg', 'JointTrajectory')
        assert message.joint_names == ['x_axis']
        assert len(message.points) == 1
        assert raw == rclpy_bytes(message, 'trajectory_msgs/msg/JointTrajectory')


@pytest.mark.parametrize('frame_id', FRAMES)
def test_wrench_comes_back(frame_id: Any) -> None:
    codec = RosbagsCodec()
    encoder, decoder = WrenchEncoder(codec, frame_id), WrenchDecoder(codec)
    for force in [(1.0, -2.0, 3.0), (math.inf, 0.0, 5e-324)]:
        raw = encoder.encode(STAMP_NS, *force)
        assert type(raw) is bytes
        assert decoder.decode(raw) == (STAMP_NS, frame_id, *force)
        assert raw == codec.serialize(
            codec.deserialize(raw, 'geometry_msgs/msg/WrenchStamped'),
            'geometry_msgs/msg/WrenchStamped',
        )


@pytest.mark.parametrize('with_velocity', [True, False])
def test_joint_state_comes_back(with_velocity: Any) -> None:
    codec = RosbagsCodec()
    encoder = JointStateEncoder(codec, 'base', 'x_axis', with_velocity)
    reading = JointStateDecoder(codec, 'x_axis').decode(encoder.encode(STAMP_NS, 0.25, -0.5))
    assert reading[:2] == (STAMP_NS, 0.25)
    assert reading.velocity == -0.5 if with_velocity else math.isnan(reading.velocity)


def test_trajectory_comes_back() -> None:
    codec = RosbagsCodec()
    encoder = TrajectoryEncoder(codec, 'base', 'x_axis')
    values = (0.1, 0.2, 0.3, 25.0)
    assert TrajectoryDecoder(codec).decode(encoder.encode(0, *values)) == (0, *values)
    assert math.isnan(TrajectoryDecoder(codec).decode(encoder.encode(0, *values[:3], math.nan))[4])


def test_time_from_start_is_zero() -> None:
    codec = RosbagsCodec()
    raw = TrajectoryEncoder(codec, 'base', 'x').encode(STAMP_NS, 1.0, 2.0, 3.0, 4.0)
    point = codec.deserialize(raw, 'trajectory_msgs/msg/JointTrajectory').points[0]
    assert (point.time_from_start.sec, point.time_from_start.nanosec) == (0, 0)


def test_negative_stamp_keeps_its_value() -> None:
    codec = RosbagsCodec()
    raw = WrenchEncoder(codec, '').encode(-1, 0.0, 0.0, 0.0)
    assert WrenchDecoder(codec).decode(raw).stamp_ns == -1


def test_string_comes_back() -> None:
    codec = RosbagsCodec()
    raw = StringEncoder(codec).encode('frozen: weak excitation, ε')
    assert codec.deserialize(raw, 'std_msgs/msg/String').data == 'frozen: weak excitation, ε'


@pytest.mark.parametrize('type_name', [
    'geometry_msgs/msg/PoseWithCovarianceStamped',
    'sensor_msgs/msg/JointState',
    'diagnostic_msgs/msg/DiagnosticArray',
    'rcl_interfaces/msg/ParameterEvent',
    'sensor_msgs/msg/PointCloud2',
])
def test_new_messages_of_any_type_can_be_serialised(type_name: Any) -> None:
    codec = RosbagsCodec()
    message = codec.new(type_name)
    raw = codec.serialize(message, type_name)
    assert codec.serialize(codec.deserialize(raw, type_name), type_name) == raw
