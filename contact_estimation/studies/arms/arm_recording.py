# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Simulated runs of an arm as rosbag2 recordings, with the faults of real sensors."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Iterator, NamedTuple

import numpy as np

from .arm_models import Arm, Array, SENSOR
from .simulation import Run, TIMESTEP
from ...messages import encode_string, TrajectoryEncoder
from ...recordings import RecordingWriter
from ...recordings.definitions import jazzy_typestore

FORCE_BIAS, TORQUE_BIAS = (2.0, -1.5, 3.0), (0.05, -0.1, 0.08)  # [N], [N m]
FORCE_NOISE, TORQUE_NOISE = 0.15, 0.01  # [N], [N m]
_POSITION_NOISE, _VELOCITY_NOISE = 5e-6, 5e-4  # [rad], [rad/s]
_REFERENCE_PERIOD = 2  # [ms]
_BEGIN_NS = 1_000_000_000_000
_JOINTS, _WRENCH = 'sensor_msgs/msg/JointState', 'geometry_msgs/msg/WrenchStamped'
_TRAJECTORY, _STRING = 'trajectory_msgs/msg/JointTrajectory', 'std_msgs/msg/String'


class Message(NamedTuple):
    """One message of a recording."""

    stamp_ns: int  # header stamp [ns]
    # topic, type_name: without leading slash; such as 'std_msgs/msg/String'
    topic: str
    type_name: str
    data: bytes  # CDR


def messages(
    arm: Arm, run: Run, joints: tuple[str, ...], urdf: str, seed: int, begin_ns: int = _BEGIN_NS
) -> Iterator[Message]:
    """
    Iterate over the messages of a run.

    Names of the joints are shuffled anew in each of four kinds of messages, among them a joint
    that is not of the arm. Joint states come before the wrench of the same stamp.

    seed: of the noise and the order of names
    begin_ns: stamp of the first message [ns]
    """
    rng, store = np.random.default_rng(seed), _Types()
    bias = np.array(FORCE_BIAS + TORQUE_BIAS)
    noise = np.repeat([FORCE_NOISE, TORQUE_NOISE], 3)
    orders = [rng.permutation(len(joints) + 1) for _ in range(4)]
    names = (*joints, 'finger_joint')
    along_normal = run.reference.x.ndim == 1
    trajectory = TrajectoryEncoder('base', 'normal')
    yield Message(begin_ns, 'robot_description', _STRING, encode_string(urdf))
    for k in range(len(run.q)):
        stamp = begin_ns + round(k * TIMESTEP * 1e9)
        if along_normal and k % _REFERENCE_PERIOD == 0:
            x, v, a = (float(column[k]) for column in run.reference)
            yield Message(stamp, 'reference_trajectory', _TRAJECTORY,
                          trajectory.encode(stamp, x, v, a, 0.0))
        if k % arm.joint_period == 0:
            order = orders[k // arm.joint_period % len(orders)]
            q = run.q[k] + rng.normal(0.0, _POSITION_NOISE, len(joints))
            q_dot = run.q_dot[k] + rng.normal(0.0, _VELOCITY_NOISE, len(joints))
            yield Message(stamp, 'joint_states', _JOINTS, store.joint_state(
                stamp, [names[i] for i in order], np.append(q, 0.0)[order],
                np.append(q_dot, 0.0)[order]))
        if k % arm.wrench_period == 0:
            wrench = run.wrench[k] + bias + noise * rng.normal(size=6)
            yield Message(stamp, 'wrench', _WRENCH, store.wrench(stamp, wrench))


def write_recording(path: Path, stream: Iterator[Message]) -> Path:
    """Write messages as a rosbag2 folder."""
    with RecordingWriter.folder(path) as writer:
        for message in stream:
            writer.write(f'/{message.topic}', message.type_name, message.data, message.stamp_ns)
    return path


class _Types:
    """Messages by rosbags, not by the library's own encoders: an independent form."""

    def __init__(self) -> None:
        self._store = jazzy_typestore()
        types = self._store.types
        self._time = types['builtin_interfaces/msg/Time']
        self._header = types['std_msgs/msg/Header']
        self._vector = types['geometry_msgs/msg/Vector3']
        self._plain = types['geometry_msgs/msg/Wrench']
        self._stamped, self._joints = types[_WRENCH], types[_JOINTS]

    def wrench(self, stamp_ns: int, wrench: Array) -> bytes:
        """Return a raw wrench in the sensor's frame."""
        force, torque = self._vector(*wrench[:3]), self._vector(*wrench[3:])
        message = self._stamped(self._headed(stamp_ns, SENSOR), self._plain(force, torque))
        return bytes(self._store.serialize_cdr(message, _WRENCH))

    def joint_state(self, stamp_ns: int, names: list[str], q: Array, q_dot: Array) -> bytes:
        """Return a raw joint state."""
        message = self._joints(self._headed(stamp_ns, ''), names, q, q_dot, np.zeros(0))
        return bytes(self._store.serialize_cdr(message, _JOINTS))

    def _headed(self, stamp_ns: int, frame: str) -> Any:
        return self._header(self._time(*divmod(stamp_ns, 1_000_000_000)), frame)
