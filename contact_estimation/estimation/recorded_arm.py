# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters and description of an arm, as recordings hold them."""

from __future__ import annotations

from typing import Any, Iterator, Mapping

from .arm_frames import static_of_parameters
from .events import DESCRIPTION, EstimationEvent, READY, START, STATIC
from .parameters import EstimationParameters
from .result import Moment
from ..exceptions import RecordingError
from ..messages import decode_string, StampedTransform, TransformsDecoder
from ..parameters.specification import specifications
from ..recordings import RecordingReader
from ..recordings.estimation_metadata import from_metadata
from ..recordings.source import RecordingSource
from ..recordings.topic_names import canonical
from ..signals.stamp_screen import BEFORE_ANY

_OF_ARMS = ('kinematics.', 'contact.', 'force_sensor.', 'tool.', 'synchronisation.',
            'physics.tool_inertia.', 'force_sign', 'frame_id', 'pose_source', 'wrench_source',
            'joint_torques_std')
BEFORE_ANY_SAMPLE = Moment(0, BEFORE_ANY)
_FILE = 'robot_description_file'


def recorded_parameters(
    reader: RecordingReader, source: RecordingSource, chosen: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the parameters at start that a recording holds."""
    known = {spec.name for spec in specifications(EstimationParameters)} - {_FILE}
    recorded = from_metadata(reader.metadata()) or _at_start(reader, source)
    recorded = {name: value for name, value in recorded.items() if name in known}
    if 'axis' in chosen:  # chosen by the user, not recorded by the node
        recorded = {k: v for k, v in recorded.items()
                    if not k.startswith(('further_axes.', 'matrix_estimator'))}
    return recorded


def arm_parameters(
    reader: RecordingReader, source: RecordingSource, chosen: Mapping[str, Any]
) -> dict[str, Any]:
    """Return those of the recorded and chosen parameters that concern an arm and its sensor."""
    every = {**recorded_parameters(reader, source, chosen), **chosen}
    return {k: v for k, v in every.items() if k.startswith((*_OF_ARMS, _FILE))}


def _at_start(reader: RecordingReader, source: RecordingSource) -> dict[str, Any]:
    event = next(recorded_events(reader, source), None)
    return dict(event.parameters) if event and event.kind == START else {}


def recorded_events(reader: RecordingReader, source: RecordingSource) -> Iterator[EstimationEvent]:
    """Yield the events of the node that a recording holds; none without their topic."""
    if canonical(source.events) in {canonical(name) for name in reader.topics()}:
        for message in reader.messages([source.events]):
            yield EstimationEvent.from_text(decode_string(message.data))


def recorded_static(
    reader: RecordingReader, source: RecordingSource
) -> list[StampedTransform]:
    """Return the static transforms of a recording."""
    events = [event for event in recorded_events(reader, source) if event.kind == STATIC]
    if events:
        return [one for event in events if event.moment == BEFORE_ANY_SAMPLE
                for one in static_of_parameters(event.parameters)]
    if canonical(source.tf_static) not in {canonical(name) for name in reader.topics()}:
        return []
    decoder = TransformsDecoder()
    return [one for message in reader.messages([source.tf_static])
            for one in decoder.decode(message.data)]


def refused_at_start(reader: RecordingReader, source: RecordingSource) -> Mapping[str, Any]:
    """Return what the node had refused before it knew the arm; see `StartUp`."""
    for event in recorded_events(reader, source):
        if event.kind == READY:
            return event.parameters
    return {}


def recorded_description(reader: RecordingReader, source: RecordingSource) -> str:
    """Return the robot description of a recording."""
    for event in recorded_events(reader, source):
        if event.kind == DESCRIPTION:
            return str(event.parameters['text'])
    there = {canonical(name) for name in reader.topics()}
    if canonical(source.robot_description) in there:
        for message in reader.messages([source.robot_description]):
            return decode_string(message.data)
    raise RecordingError(
        f'{reader.path} has no robot description on {canonical(source.robot_description)}, which '
        'kinematics.tip needs; give the URDF as robot_description_file in --params, or record the '
        'topic'
    )
