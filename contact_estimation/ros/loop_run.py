# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""The signals that a run of the loop recorded, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
import json
from pathlib import Path
from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from ..exceptions import RecordingError
from ..messages import (
    decode_float64, JointStateDecoder, TrajectoryDecoder, Vector3StampedDecoder, WrenchDecoder)
from ..recordings import RecordingReader

Series = NDArray[np.float64]
Decode = Callable[[bytes], tuple[int, dict[str, float]]]

_ESTIMATES = ('stiffness', 'damping', 'stiffness_std', 'damping_std')
_SIGNALS = ('position', 'desired', 'desired_force', 'reference', 'model_fit', *_ESTIMATES)


@dataclass(frozen=True)
class RecordedRun:
    """A run of the loop."""

    # (N, 2) time since the start [s] and value of force, position, desired, desired_force,
    # reference, model_fit and the estimates
    series: dict[str, Series]
    # the plant node's own summary; empty after a crash
    plant: dict[str, Any] = field(default_factory=dict)

    def last_before(self, name: str, t: float) -> float:
        """
        Return the last value of a series up to an instant.

        t: time since the start [s]
        """
        series = self.series[name]
        index = int(np.searchsorted(series[:, 0], t + 1e-6, side='right')) - 1
        return float(series[index, 1]) if index >= 0 else float('nan')


def read_run(recording: Path, plant_summary: Path) -> RecordedRun:
    """Read a run."""
    reader = RecordingReader(recording)
    decoders = _decoders(reader)
    rows: dict[str, list[tuple[int, float]]] = {}
    for topic, log_time_ns, data in reader.messages(list(decoders)):
        stamp_ns, values = decoders[topic](data)
        stamp_ns = stamp_ns or log_time_ns
        for name, value in values.items():
            rows.setdefault(name, []).append((stamp_ns, value))
    if 'force' not in rows:
        raise RecordingError(f'{recording} has no wrench; expected messages on /wrench, check '
                             'that the plant node started')
    plant = json.loads(plant_summary.read_text()) if plant_summary.exists() else {}
    begin_ns = plant.get('begin_stamp_ns') or rows['force'][0][0]
    series = {
        name: np.array([((stamp - begin_ns) * 1e-9, value) for stamp, value in pairs])
        for name, pairs in rows.items()
    }
    return RecordedRun({**{name: np.empty((0, 2)) for name in _SIGNALS}, **series}, plant)


def _decoders(reader: RecordingReader) -> dict[str, Decode]:
    """Return for each recorded topic the function that decodes stamp and values."""
    wrench, joints = WrenchDecoder(), JointStateDecoder()
    setpoints, references = TrajectoryDecoder(), TrajectoryDecoder()
    vector = Vector3StampedDecoder()

    def of_wrench(raw: bytes) -> tuple[int, dict[str, float]]:
        message = wrench.decode(raw)
        return message.stamp_ns, {'force': message.force_x}

    def of_joints(raw: bytes) -> tuple[int, dict[str, float]]:
        message = joints.decode(raw)
        return message.stamp_ns, {'position': message.position}

    def of_setpoint(raw: bytes) -> tuple[int, dict[str, float]]:
        message = setpoints.decode(raw)
        return message.stamp_ns, {'desired': message.position, 'desired_force': message.effort}

    def of_reference(raw: bytes) -> tuple[int, dict[str, float]]:
        message = references.decode(raw)
        return message.stamp_ns, {'reference': message.position}

    def of_vector(name: str) -> Decode:
        def decode(raw: bytes) -> tuple[int, dict[str, float]]:
            stamp_ns, x, _, _ = vector.decode(raw)
            return stamp_ns, {name: x}

        return decode

    def of_fit(raw: bytes) -> tuple[int, dict[str, float]]:
        return 0, {'model_fit': decode_float64(raw)}  # has no stamp

    decoders: dict[str, Decode] = {
        '/wrench': of_wrench, '/joint_states': of_joints, '/desired_trajectory': of_setpoint,
        '/reference_trajectory': of_reference,
        '/estimator_node/model_fit': of_fit,
        **{f'/estimator_node/{name}': of_vector(name) for name in _ESTIMATES},
    }
    recorded = reader.topics()
    return {topic: decode for topic, decode in decoders.items() if topic in recorded}
