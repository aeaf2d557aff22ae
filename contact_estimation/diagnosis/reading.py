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

"""The signals of a recording, each with its own stamps."""

from __future__ import annotations

from math import isfinite
from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from .observed import Signals
from ..exceptions import MessageError, RecordingError
from ..messages import (
    FORCE_OF_AXIS,
    JointStateDecoder,
    RosbagsCodec,
    TrajectoryDecoder,
    WrenchDecoder,
)
from ..recording_replay import RecordingSource
from ..recordings import RecordingReader
from ..recordings.topic_names import canonical

Array = NDArray[np.float64]
Row = tuple[int, tuple[float, ...]]


def read_signals(
    reader: RecordingReader, source: RecordingSource, axis: str, joint: str
) -> Signals:
    """
    Read wrench, joint and reference of the contact axis.

    Parameters
    ----------
    reader : RecordingReader
        The recording.
    source : RecordingSource
        Its topics.
    axis : str
        Of the force: 'x', 'y' or 'z'.
    joint : str
        Name; '' is the only one.

    Returns
    -------
    signals : Signals
        In the order of their stamps, without what is not finite.

    Raises
    ------
    RecordingError
        If a topic is missing or has no usable message.

    """
    asked = [source.wrench, source.joint_states]
    topics = {canonical(name) for name in reader.topics()}
    with_reference = canonical(source.reference_trajectory) in topics
    if with_reference:
        asked.append(source.reference_trajectory)
    rows: dict[str, list[Row]] = {name: [] for name in asked}
    decode, refused = _decoders(source, axis, joint), ''
    for batch in reader.batches(asked):
        for topic, _, data in batch:
            try:
                rows[topic].append(decode[topic](data))
            except MessageError as error:
                refused = f'; {topic}: {error}'
    wrench = _stacked(rows[source.wrench], 1)
    joints = _stacked(rows[source.joint_states], 1)
    references = _stacked(rows.get(source.reference_trajectory, []), 4)
    for name, stamps in ((source.wrench, wrench[0]), (source.joint_states, joints[0])):
        if not len(stamps):
            raise RecordingError(
                f'no usable message on {name} in {reader.path}: expected finite values with '
                f'stamps, got none{refused}; check topic, axis and joint'
            )
    start = int(wrench[0][0])
    times: list[Array] = [np.asarray((stamps - start) * 1e-9, np.float64)
                          for stamps, _ in (wrench, joints, references)]
    return Signals(times[0], wrench[1][0], times[1], joints[1][0], times[2], references[1])


def _decoders(
    source: RecordingSource, axis: str, joint: str
) -> dict[str, Callable[[bytes], Row]]:
    codec = RosbagsCodec()
    wrench, joints = WrenchDecoder(codec), JointStateDecoder(codec, joint)
    references, force_of = TrajectoryDecoder(codec, joint), FORCE_OF_AXIS[axis]

    def force(data: bytes) -> Row:
        reading = wrench.decode(data)
        return reading.stamp_ns, (force_of(reading),)

    def position(data: bytes) -> Row:
        reading = joints.decode(data)
        return reading.stamp_ns, (reading.position,)

    def reference(data: bytes) -> Row:
        stamp_ns, *values = references.decode(data)
        # What a reference does not say is 0: no feed-forward, no force wanted.
        return stamp_ns, tuple(0.0 if value != value else value for value in values)

    return {source.wrench: force, source.joint_states: position,
            source.reference_trajectory: reference}


def _stacked(rows: list[Row], width: int) -> tuple[NDArray[np.int64], Array]:
    """Sort by stamp; of equal stamps the first stays, what is not finite goes."""
    finite = [row for row in rows if all(map(isfinite, row[1]))]
    stamps: Any = np.array([stamp for stamp, _ in finite], np.int64)
    stamps, first = np.unique(stamps, return_index=True)
    values = np.array([values for _, values in finite], np.float64).reshape(-1, width)
    return stamps, values[first].T
