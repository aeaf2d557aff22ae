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

"""Parameters and description of an arm, as recordings hold them."""

from __future__ import annotations

from typing import Any, Mapping

from .events import DESCRIPTION, EstimationEvent, START
from .parameters import EstimationParameters
from ..exceptions import RecordingError
from ..messages import decode_string
from ..parameters.specification import specifications
from ..recordings import RecordingReader
from ..recordings.estimation_metadata import from_metadata
from ..recordings.source import RecordingSource
from ..recordings.topic_names import canonical

_OF_ARMS = ('kinematics.', 'contact.', 'force_sensor.', 'tool.', 'synchronisation.',
            'physics.tool_inertia.', 'force_sign', 'frame_id')
_FILE = 'robot_description_file'


def recorded_parameters(
    reader: RecordingReader, source: RecordingSource, chosen: Mapping[str, Any]
) -> dict[str, Any]:
    """
    Return the parameters at start that a recording holds.

    Parameters
    ----------
    reader : RecordingReader
        The recording.
    source : RecordingSource
        Its topics; without metadata, the event at start is used, which any recorder may have
        recorded.
    chosen : mapping
        Parameters chosen by the user.

    Returns
    -------
    parameters : dict
        Dotted name to value, without those that no longer exist (a recording may be years old)
        or that the choice makes meaningless. Never with the file of the description, which may be
        missing or have changed: the recording holds its text.

    """
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
    if canonical(source.events) not in {canonical(name) for name in reader.topics()}:
        return {}
    first = next(reader.messages([source.events]), None)
    event = EstimationEvent.from_text(decode_string(first.data)) if first else None
    return dict(event.parameters) if event and event.kind == START else {}


def recorded_description(reader: RecordingReader, source: RecordingSource) -> str:
    """
    Return the robot description of a recording.

    Parameters
    ----------
    reader : RecordingReader
        The recording.
    source : RecordingSource
        Its topics: the events of the node hold the text that the node used, else
        `robot_description` has it.

    Returns
    -------
    description : str
        Text of the URDF.

    Raises
    ------
    RecordingError
        If there is none.

    """
    there = {canonical(name) for name in reader.topics()}
    if canonical(source.events) in there:
        for message in reader.messages([source.events]):
            event = EstimationEvent.from_text(decode_string(message.data))
            if event.kind == DESCRIPTION:
                return str(event.parameters['text'])
    if canonical(source.robot_description) in there:
        for message in reader.messages([source.robot_description]):
            return decode_string(message.data)
    raise RecordingError(
        f'{reader.path} has no robot description on {canonical(source.robot_description)}, which '
        'kinematics.tip needs; give the URDF as robot_description_file in --params, or record the '
        'topic'
    )
