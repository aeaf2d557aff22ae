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

"""The signals of a recording as arrays, each with its own stamps."""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from typing import Callable

import numpy as np
from numpy.typing import NDArray

from .reading import RecordingReader
from .source import RecordingSource
from .topic_names import canonical
from ..exceptions import MessageError, RecordingError
from ..messages import FORCE_OF_AXIS, JointStateDecoder, TrajectoryDecoder, WrenchDecoder

Row = tuple[int, tuple[float, ...]]


@dataclass(frozen=True)
class Signal:
    """
    One topic of the contact axis, sorted by stamp, without non-finite samples.

    Attributes
    ----------
    stamp_ns : ndarray of int64, shape (N,)
        Header stamps [ns], strictly increasing.
    values : ndarray, shape (n, N)
        wrench: F_e [N]; joint_states: x [m] and its rate [m/s], NaN where not recorded;
        reference_trajectory: x_r [m], its rate [m/s] and acceleration [m/s^2], F_r [N].

    """

    stamp_ns: NDArray[np.int64]
    values: NDArray[np.float64]

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.stamp_ns)


@dataclass(frozen=True)
class RecordedSignals:
    """
    The signals of the contact axis in a recording.

    Attributes
    ----------
    wrench, joint_states : Signal
        Never empty.
    reference_trajectory : Signal
        Empty where none was recorded.
    frame_id : str
        Frame of the wrench.

    """

    wrench: Signal
    joint_states: Signal
    reference_trajectory: Signal
    frame_id: str


def read_signals(
    reader: RecordingReader, source: RecordingSource, axis: str = 'x', joint: str = '',
    most_samples: int | None = None,
) -> RecordedSignals:
    """
    Read wrench, joint and reference of the contact axis.

    Parameters
    ----------
    reader : RecordingReader
        The recording.
    source : RecordingSource
        Its topics.
    axis : str
        Axis of the force: 'x', 'y' or 'z'.
    joint : str
        Name of the joint; '' is the only joint of the message.
    most_samples : int, optional
        Number of wrenches after which reading stops, a bound of the memory; all by default.

    Returns
    -------
    signals : RecordedSignals
        Of samples with equal stamps, the first is kept.

    Raises
    ------
    RecordingError
        If a topic is missing or has no usable message.

    """
    asked = [source.wrench, source.joint_states]
    recorded = {canonical(name) for name in reader.topics()}
    if canonical(source.reference_trajectory) in recorded:
        asked.append(source.reference_trajectory)
    wrenches = WrenchDecoder()
    decode = _decoders(wrenches, source, axis, joint)
    # Arrays of plain numbers: hours at 1 kHz are millions of messages.
    stamps = {name: array('q') for name in decode}
    rows = {name: array('d') for name in decode}
    refused: dict[str, str] = {}
    for topic, _, data in reader.messages(asked):
        try:
            stamp_ns, values = decode[topic](data)
        except MessageError as error:
            refused[topic] = f': {error}'
            continue
        stamps[topic].append(stamp_ns)
        rows[topic].extend(values)
        if len(stamps[source.wrench]) == most_samples:
            break
    wrench, joints, reference = (
        _stacked(stamps[name], rows[name], width) for name, width in zip(decode, (1, 2, 4))
    )
    for name, signal in zip(asked, (wrench, joints)):
        if not len(signal):
            raise RecordingError(
                f'no usable message on {name} in {reader.path}: expected finite values with '
                f'stamps, got none{refused.get(name, "")}; check topic, axis and joint'
            )
    return RecordedSignals(wrench, joints, reference, wrenches.frame_id)


def _decoders(
    wrenches: WrenchDecoder, source: RecordingSource, axis: str, joint: str
) -> dict[str, Callable[[bytes], Row]]:
    joints, references = JointStateDecoder(joint), TrajectoryDecoder(joint)
    force_of = FORCE_OF_AXIS[axis]

    def force(data: bytes) -> Row:
        reading = wrenches.decode(data)
        return reading.stamp_ns, (force_of(reading),)

    def motion(data: bytes) -> Row:
        stamp_ns, *values = joints.decode(data)
        return stamp_ns, tuple(values)

    def reference(data: bytes) -> Row:
        stamp_ns, x, *rest = references.decode(data)
        # Missing entries of a reference are 0: no feed-forward, no desired force.
        return stamp_ns, (x, *(0.0 if value != value else value for value in rest))

    return {source.wrench: force, source.joint_states: motion,
            source.reference_trajectory: reference}


def _stacked(stamps: array[int], rows: array[float], width: int) -> Signal:
    """Sort by stamp; drop non-finite samples and all but the first of equal stamps."""
    stamp_ns = np.array(stamps, np.int64)
    values = np.array(rows, np.float64).reshape(-1, width)
    finite = np.isfinite(values[:, 0])
    stamp_ns, first = np.unique(stamp_ns[finite], return_index=True)
    return Signal(stamp_ns, values[finite][first].T)
