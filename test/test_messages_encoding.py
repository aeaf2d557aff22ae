# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Encoders write the bytes that rosbags and rclpy write, and decoders read them back."""

from __future__ import annotations

from itertools import product
import math
from typing import Any

from contact_estimation.messages import (
    decode_float64,
    decode_string,
    encode_float64,
    encode_multi_array,
    encode_string,
    JointStateEncoder,
    TrajectoryEncoder,
    Vector3StampedEncoder,
    WrenchEncoder,
)
import numpy as np
import pytest
from reference_messages import (
    FLOAT64,
    joint_state_bytes,
    new,
    serialized,
    STRING,
    trajectory_bytes,
    vector_bytes,
    wrench_bytes,
)

FRAMES = ['abcdefghi'[:n] for n in range(10)]
NAMES = ['x', 'xyz', 'x_axis', 'contact_x']
STAMP_NS = 1_750_000_000_123_456_789
HEAD: Any = {'stamp_ns': STAMP_NS}


def test_vector_has_the_bytes_of_rosbags() -> None:
    for frame_id in FRAMES:
        values = (1.0, -math.inf, 5e-324)
        raw = Vector3StampedEncoder(frame_id).encode(STAMP_NS, *values)
        assert raw == vector_bytes(values, frame_id=frame_id, **HEAD), frame_id


def test_wrench_has_the_bytes_of_rosbags() -> None:
    for frame_id in FRAMES:
        raw = WrenchEncoder(frame_id).encode(STAMP_NS, 1.0, -2.0, 3.0)
        assert raw == wrench_bytes((1.0, -2.0, 3.0), frame_id=frame_id, **HEAD), frame_id
        assert type(raw) is bytes, frame_id


def test_joint_state_has_the_bytes_of_rosbags() -> None:
    for frame_id, name, with_velocity in product(FRAMES, NAMES, (True, False)):
        raw = JointStateEncoder(frame_id, name, with_velocity).encode(STAMP_NS, 0.25, -0.5)
        velocity = [-0.5] * with_velocity
        expected = joint_state_bytes([name], [0.25], velocity, frame_id=frame_id, **HEAD)
        assert raw == expected, (frame_id, name, with_velocity)


def test_trajectory_has_the_bytes_of_rosbags() -> None:
    fields = ('positions', 'velocities', 'accelerations', 'effort')
    point = {field: [value] for field, value in zip(fields, (1.0, 2.0, 3.0, math.nan))}
    for frame_id, name in product(FRAMES, NAMES):
        raw = TrajectoryEncoder(frame_id, name).encode(STAMP_NS, 1.0, 2.0, 3.0, math.nan)
        expected = trajectory_bytes([name], [point], frame_id=frame_id, **HEAD)
        assert raw == expected, (frame_id, name)


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
