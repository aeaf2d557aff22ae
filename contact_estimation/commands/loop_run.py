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

"""What a run of the loop has recorded, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
import json
from pathlib import Path
from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from ..exceptions import RecordingError
from ..messages import (
    JointStateDecoder,
    TrajectoryDecoder,
    Vector3StampedDecoder,
    WrenchDecoder,
)
from ..recordings import RecordingReader

Series = NDArray[np.float64]

_ESTIMATES = ('stiffness', 'damping', 'stiffness_std', 'damping_std')


@dataclass(frozen=True)
class LoopRun:
    """
    A run of the loop.

    Attributes
    ----------
    series : dict
        Name to array of shape (N, 2): time since the start [s] and value. Names are force,
        position, desired, desired_force, reference and those of the estimates.
    plant : dict
        What the plant has written at its end.

    """

    series: dict[str, Series]
    plant: dict[str, Any] = field(default_factory=dict)

    def last_before(self, name: str, t: float) -> float:
        """
        Take the last value of a series up to an instant.

        Parameters
        ----------
        name : str
            Of the series.
        t : float
            Time since the start [s].

        Returns
        -------
        value : float
            NaN where there is none.

        """
        series = self.series[name]
        index = int(np.searchsorted(series[:, 0], t + 1e-6, side='right')) - 1
        return float(series[index, 1]) if index >= 0 else float('nan')


def read_run(recording: Path, plant_summary: Path) -> LoopRun:
    """
    Read what a run has left.

    Parameters
    ----------
    recording : Path
        The recording.
    plant_summary : Path
        What the plant has written; it may be missing after a crash.

    Returns
    -------
    run : LoopRun
        All series.

    Raises
    ------
    RecordingError
        If nothing was recorded.

    """
    reader = RecordingReader(recording)
    decoders = _decoders(reader)
    rows: dict[str, list[tuple[int, float]]] = {}
    for topic, _, data in reader.messages(list(decoders)):
        stamp_ns, values = decoders[topic](data)
        for name, value in values.items():
            rows.setdefault(name, []).append((stamp_ns, value))
    if 'force' not in rows:
        raise RecordingError(f'{recording} holds no wrench; did the plant start?')
    plant = json.loads(plant_summary.read_text()) if plant_summary.exists() else {}
    begin = plant.get('begin_stamp_ns') or rows['force'][0][0]
    series = {name: _array(pairs, begin) for name, pairs in rows.items()}
    for name in ('position', 'desired', 'desired_force', 'reference', *_ESTIMATES):
        series.setdefault(name, np.empty((0, 2)))
    return LoopRun(series, plant)


def _array(pairs: list[tuple[int, float]], begin_ns: int) -> Series:
    return np.array([((stamp - begin_ns) * 1e-9, value) for stamp, value in pairs])


def _decoders(
    reader: RecordingReader,
) -> dict[str, Callable[[bytes], tuple[int, dict[str, float]]]]:
    """Say for each recorded topic what a message of it gives."""
    wrench, joints = WrenchDecoder(), JointStateDecoder()
    wishes, references = TrajectoryDecoder(), TrajectoryDecoder()
    vector = Vector3StampedDecoder()

    def of_wrench(raw: bytes) -> tuple[int, dict[str, float]]:
        reading = wrench.decode(raw)
        return reading.stamp_ns, {'force': reading.force_x}

    def of_joints(raw: bytes) -> tuple[int, dict[str, float]]:
        reading = joints.decode(raw)
        return reading.stamp_ns, {'position': reading.position}

    def of_wish(raw: bytes) -> tuple[int, dict[str, float]]:
        reading = wishes.decode(raw)
        return reading.stamp_ns, {'desired': reading.position, 'desired_force': reading.effort}

    def of_reference(raw: bytes) -> tuple[int, dict[str, float]]:
        reading = references.decode(raw)
        return reading.stamp_ns, {'reference': reading.position}

    def of_vector(name: str) -> Callable[[bytes], tuple[int, dict[str, float]]]:
        def decode(raw: bytes) -> tuple[int, dict[str, float]]:
            stamp_ns, x, _, _ = vector.decode(raw)
            return stamp_ns, {name: x}

        return decode

    wanted = {
        '/wrench': of_wrench, '/joint_states': of_joints, '/desired_trajectory': of_wish,
        '/reference_trajectory': of_reference,
        **{f'/estimator_node/{name}': of_vector(name) for name in _ESTIMATES},
    }
    there = reader.topics()
    return {topic: decode for topic, decode in wanted.items() if topic in there}
