# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Writing of a simulation as a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Iterator

from .simulation import Simulation
from ..messages import JointStateEncoder, TrajectoryEncoder, WrenchEncoder
from ..recordings.topic_names import canonical
from ..recordings.writing import RecordingWriter

_WRENCH = 'geometry_msgs/msg/WrenchStamped'
_JOINT_STATE = 'sensor_msgs/msg/JointState'
_TRAJECTORY = 'trajectory_msgs/msg/JointTrajectory'
Entry = tuple[int, str, str, bytes]  # stamp, topic, type, message


def write_simulation(
    path: Path, simulation: Simulation, axis: str, joint: str, frame_id: str
) -> None:
    """Write a simulation to an MCAP file."""
    entries = [
        *_references(simulation, TrajectoryEncoder(frame_id, joint)),
        *_samples(simulation, axis, joint, frame_id),
    ]
    entries.sort(key=lambda entry: entry[0])
    with RecordingWriter.file(path) as writer:
        for stamp_ns, topic, type_name, data in entries:
            writer.write(canonical(topic), type_name, data, stamp_ns)


def _references(simulation: Simulation, encoder: TrajectoryEncoder) -> Iterator[Entry]:
    rows = simulation.reference.T.tolist()
    for stamp_ns, row in zip(simulation.reference_ns.tolist(), rows):
        yield stamp_ns, 'reference_trajectory', _TRAJECTORY, encoder.encode(stamp_ns, *row)


def _samples(simulation: Simulation, axis: str, joint: str, frame_id: str) -> Iterator[Entry]:
    force, position, velocity = simulation.measured.tolist()
    published = all(v == v for v in velocity)
    wrenches = WrenchEncoder(frame_id)
    joints = JointStateEncoder(frame_id, joint, published)
    place = 'xyz'.index(axis)
    for stamp_ns, F, x, v in zip(simulation.stamp_ns.tolist(), force, position, velocity):
        vector = [0.0, 0.0, 0.0]
        vector[place] = F
        yield stamp_ns, 'joint_states', _JOINT_STATE, joints.encode(stamp_ns, x, v)
        yield stamp_ns, 'wrench', _WRENCH, wrenches.encode(stamp_ns, *vector)
