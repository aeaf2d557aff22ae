# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Messages as rosbags serialises them, the reference for this package's own CDR layouts."""

from pathlib import Path
from typing import Any, Iterable, Mapping, Sequence

from contact_estimation.recordings import RecordingWriter
import numpy as np
from rosbags.typesys import get_typestore, Stores

WRENCH = 'geometry_msgs/msg/WrenchStamped'
VECTOR = 'geometry_msgs/msg/Vector3Stamped'
JOINTS = 'sensor_msgs/msg/JointState'
TRAJECTORY = 'trajectory_msgs/msg/JointTrajectory'
FLOAT64 = 'std_msgs/msg/Float64'
STRING = 'std_msgs/msg/String'
TF = 'tf2_msgs/msg/TFMessage'
TYPES = {'/joint_states': JOINTS, '/wrench': WRENCH, '/tf': TF, '/tf_static': TF,
         '/estimator_node/events': STRING, '/robot_description': STRING}
"""Of topics."""

STORE = get_typestore(Stores.ROS2_JAZZY)
_TYPES = {name.rsplit('/', 1)[-1]: cls for name, cls in STORE.types.items()}


def new(name: str, *fields: Any) -> Any:
    """Build a message or a part of one by its short type name."""
    return _TYPES[name](*fields)


def header(stamp_ns: int = 0, frame_id: str = '') -> Any:
    return new('Header', new('Time', *divmod(stamp_ns, 10**9)), frame_id)


def serialized(message: Any, type_name: str, little_endian: bool = True) -> bytes:
    return bytes(STORE.serialize_cdr(message, type_name, little_endian=little_endian))


def deserialized(raw: bytes, type_name: str) -> Any:
    return STORE.deserialize_cdr(raw, type_name)


def wrench_bytes(
    force: Sequence[float], torque: Sequence[float] = (0.0, 0.0, 0.0), little_endian: bool = True,
    **of_header: Any,
) -> bytes:
    parts = (new('Vector3', *map(float, vector)) for vector in (force, torque))
    message = new('WrenchStamped', header(**of_header), new('Wrench', *parts))
    return serialized(message, WRENCH, little_endian)


def vector_bytes(vector: Sequence[float], **of_header: Any) -> bytes:
    message = new('Vector3Stamped', header(**of_header), new('Vector3', *map(float, vector)))
    return serialized(message, VECTOR)


def joint_state_bytes(
    names: Sequence[str], position: Sequence[float], velocity: Sequence[float] = (),
    effort: Sequence[float] = (), little_endian: bool = True, **of_header: Any,
) -> bytes:
    arrays = (np.array(values, np.float64) for values in (position, velocity, effort))
    message = new('JointState', header(**of_header), list(names), *arrays)
    return serialized(message, JOINTS, little_endian)


def trajectory_bytes(
    names: Sequence[str], points: Sequence[Mapping[str, Sequence[float]]],
    little_endian: bool = True, **of_header: Any,
) -> bytes:
    fields = ('positions', 'velocities', 'accelerations', 'effort')
    made = [
        new('JointTrajectoryPoint', *(np.array(p.get(f, ()), np.float64) for f in fields),
            new('Duration', number, 0))
        for number, p in enumerate(points)]
    message = new('JointTrajectory', header(**of_header), list(names), made)
    return serialized(message, TRAJECTORY, little_endian)


def transforms_bytes(
    transforms: Sequence[tuple[int, str, str, Sequence[float]]], little_endian: bool = True
) -> bytes:
    """Serialise stamps [ns], parents, children and poses (x, y, z, qx, qy, qz, qw)."""
    made = [
        new('TransformStamped', header(stamp_ns, parent), child, new(
            'Transform', new('Vector3', *map(float, pose[:3])),
            new('Quaternion', *map(float, pose[3:]))))
        for stamp_ns, parent, child, pose in transforms]
    return serialized(new('TFMessage', made), TF, little_endian)


def write(
    path: Path, listed: Iterable[tuple[str, int, bytes]],
    metadata: Mapping[str, dict[str, str]] = {},
) -> Path:
    """Record messages, given by topic, stamp and content."""
    with RecordingWriter.file(path) as writer:
        for topic, stamp_ns, raw in listed:
            writer.write(topic, TYPES[topic], raw, stamp_ns)
        for name, values in metadata.items():
            writer.write_metadata(name, values)
    return path
