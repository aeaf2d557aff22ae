# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Where and how a recording is read: topics by role, with and without leading slash."""

from dataclasses import dataclass, field
import difflib
import json
from typing import Any, Collection, Mapping

from ..exceptions import RecordingError, UnknownNameError
from ..texts import json_content

TYPES = {'wrench': 'geometry_msgs/msg/WrenchStamped', 'joint_states': 'sensor_msgs/msg/JointState',
         'reference_trajectory': 'trajectory_msgs/msg/JointTrajectory'}
"""Of messages, by the role of their topic."""

_WITHOUT_SENSOR = (
    '; of an arm without a force sensor, set wrench_source to joint_efforts (--params)')


def canonical(topic: str) -> str:
    """Write a topic name with its leading slash: 'wrench' and '/wrench' are the same."""
    return '/' + topic.strip('/')


def require_topics(asked: Collection[str], types: Mapping[str, str], where: str) -> None:
    """Check that a recording has the requested topics."""
    present = {canonical(topic) for topic in types}
    missing = [topic for topic in asked if canonical(topic) not in present]
    if not missing:
        return
    there = ', '.join(f'{topic} ({types[topic]})' for topic in sorted(types)) or 'no topics'
    role = missing[0].rsplit('/', 1)[-1]
    likewise = ''
    if role not in TYPES:  # chosen with --topic for an unknown role
        role, *others = TYPES
        likewise = f' (likewise {", ".join(others)})'
    unmeasured = role == 'wrench' and any('JointState' in kind for kind in types.values()) and (
        not any('Wrench' in kind for kind in types.values()))
    raise RecordingError(
        f'{where} has no topic {", ".join(canonical(topic) for topic in missing)}; it has: '
        f'{there}; say which one to read with --topic {role}:='
        f'{_nearest(missing[0], types)}{likewise}' + _WITHOUT_SENSOR * unmeasured)


def _nearest(topic: str, types: Mapping[str, str]) -> str:
    """Suggest the topic with the most similar last part."""
    by_last_part = {name.rsplit('/', 1)[-1]: name for name in sorted(types)}
    wanted = topic.rsplit('/', 1)[-1]
    near = difflib.get_close_matches(wanted, by_last_part, n=1, cutoff=0.5)
    return by_last_part[near[0]] if near else '/name'


TOPICS = ('wrench', 'joint_states', 'reference_trajectory', 'robot_description', 'tf', 'tf_static')


@dataclass(frozen=True)
class RecordingSource:
    """Topics or columns of a recording that hold the contact signals, and how they are read."""

    # wrench, joint_states, reference_trajectory: topics
    wrench: str = 'wrench'
    joint_states: str = 'joint_states'
    reference_trajectory: str = 'reference_trajectory'
    robot_description: str = 'robot_description'  # topic of the URDF of an arm
    # tf, tf_static: topics of the transforms of frames
    tf: str = 'tf'
    tf_static: str = 'tf_static'
    events: str = 'estimator_node/events'  # topic of the estimator node's events
    # of a table: column by signal, such as {'t': 'time', 'wrench.force.z': 'Fz'}; others are found
    # by name
    columns: Mapping[str, str] = field(default_factory=dict)
    # of a table: units of its columns, such as ('mm', 'N'); SI by default
    units: tuple[str, ...] = ()
    # 'header', or 'received' for the time at which the bag received each message
    stamps: str = 'header'
    # where messages that are no WrenchStamped hold force and torque, such as 'data[0:6]'
    wrench_field: str = ''
    # when the force is zero: 'first-free-flight', or a span 'A:B' [s from the first wrench]; '':
    # as recorded. Used where the force along the contact axis is known.
    tare: str = ''

    @classmethod
    def of_topics(cls, topics: Mapping[str, str], **reading: Any) -> 'RecordingSource':
        """
        Return the source with other topics than the default ones.

        topics: recorded topic by its name here, one of `TOPICS`
        **reading: attributes that are no topics
        Returns source: a topic that is not given keeps its default
        """
        for name in topics:
            if name.strip('/') not in TOPICS:
                raise UnknownNameError.among('topic', name, TOPICS)
        chosen: dict[str, Any] = {name.strip('/'): topic for name, topic in topics.items()}
        return cls(**chosen, **reading)


RECORD = 'estimator_node'


def to_metadata(parameters: Mapping[str, Any]) -> dict[str, str]:
    """Write parameters as the texts that a metadata record takes."""
    return {name: json.dumps(value) for name, value in parameters.items()}


def from_metadata(records: Mapping[str, Mapping[str, str]]) -> dict[str, Any]:
    """Read the parameters at start."""
    try:
        return {name: json_content(text) for name, text in records.get(RECORD, {}).items()}
    except ValueError as error:
        raise RecordingError(
            f'metadata record {RECORD!r} must hold JSON values, got an unreadable one: {error}; '
            'write a copy without it by `convert`, to CSV and back') from error
