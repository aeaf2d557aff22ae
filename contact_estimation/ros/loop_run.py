# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The signals that a run of the loop recorded, their figure and their summary."""

from dataclasses import dataclass, field
import json
from math import inf, isfinite, nan
from pathlib import Path
from typing import Any, Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from .loop_processes import LoopConfiguration
from ..exceptions import RecordingError
from ..pipeline.estimate_files import plot_contact
from ..plant.plant_parameters import WallParameters
from ..recordings import RecordingReader
from ..recordings.decoding import (
    decode_float64, JointStateDecoder, TrajectoryDecoder, Vector3StampedDecoder, WrenchDecoder)
from ..reference.experiment import Experiment


def plot_run(
    run: 'RecordedRun', title: str, wall: WallParameters, force_note: str = '', warning: str = ''
) -> Any:
    """Plot a run."""
    true = {'stiffness': wall.stiffness, 'damping': wall.damping}
    return plot_contact(run.series, title, true, force_note, warning)


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
        """Return the last value of a series up to an instant; t: time since the start [s]."""
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
    def fields_of(decoder: Any, **fields: str) -> Decode:
        def decode(raw: bytes) -> tuple[int, dict[str, float]]:
            message = decoder.decode(raw)
            return message.stamp_ns, {name: getattr(message, field)
                                      for name, field in fields.items()}

        return decode

    def of_vector(name: str) -> Decode:
        decoder = Vector3StampedDecoder()

        def decode(raw: bytes) -> tuple[int, dict[str, float]]:
            stamp_ns, x, _, _ = decoder.decode(raw)
            return stamp_ns, {name: x}

        return decode

    decoders: dict[str, Decode] = {
        '/wrench': fields_of(WrenchDecoder(), force='force_x'),
        '/joint_states': fields_of(JointStateDecoder(), position='position'),
        '/desired_trajectory': fields_of(
            TrajectoryDecoder(), desired='position', desired_force='effort'),
        '/reference_trajectory': fields_of(TrajectoryDecoder(), reference='position'),
        # It has no stamp.
        '/estimator_node/model_fit': lambda raw: (0, {'model_fit': decode_float64(raw)}),
        **{f'/estimator_node/{name}': of_vector(name) for name in _ESTIMATES},
    }
    recorded = reader.topics()
    return {topic: decode for topic, decode in decoders.items() if topic in recorded}


_LATE_CYCLES = 2.0
_LEAST_GAP = 0.02  # of the desired force
_EXPLAINED = 0.1  # of the gap


def summarise(run: RecordedRun, configuration: LoopConfiguration) -> dict[str, Any]:
    """Return the content of summary.json."""
    measured, wall = run.plant, configuration.plant.environment
    last_contact = measured.get('last_contact_stamp_ns')
    t = (last_contact - measured['begin_stamp_ns']) * 1e-9 if last_contact else -1.0
    stiffness, damping = run.last_before('stiffness', t), run.last_before('damping', t)
    values = {
        'estimator': configuration.estimation.estimator,
        'law': configuration.law,
        'stiffness': stiffness,
        'damping': damping,
        'stiffness_error_percent': 100.0 * (stiffness / wall.stiffness - 1.0),
        'damping_error_percent':
            100.0 * (damping / wall.damping - 1.0) if wall.damping > 0.0 else nan,
        'mean_force_n': -_over_hold(run.series['force'], configuration.experiment),
        'desired_force_n': configuration.experiment.desired_force,
        'eq20_force_n': _eq20_force(run, configuration),
        'model_fit': run.last_before('model_fit', inf),
        'model_fit_worst': max(filter(isfinite, run.series['model_fit'][:, 1].tolist()),
                               default=nan),
        **{name: measured.get(name)
           for name in ('rate_hz', 'samples_sent', 'samples_lost', 'latency_ms')},
    }
    summary = {name: None if isinstance(value, float) and not isfinite(value) else value
               for name, value in values.items()}
    return {**summary, 'disturbed': disturbances(measured, configuration.plant.sample_rate)}


def disturbances(measured: Mapping[str, Any], sample_rate: float) -> list[str]:
    """Return why a run does not show what the estimator does on an idle machine."""
    reasons = []
    sent, lost = measured.get('samples_sent'), measured.get('samples_lost')
    if lost:
        reasons.append(f'{lost} of {sent} samples dropped')
    longest = (measured.get('latency_ms') or {}).get('max')
    limit = _LATE_CYCLES * 1e3 / sample_rate
    if longest is not None and longest > limit:
        late = measured.get('samples_late')
        how_many = f'{late} samples' if late else 'some samples'
        reasons.append(f'latency of {how_many} over two cycles ({limit:.3g} ms), up to '
                       f'{longest:.3g} ms')
    return reasons


def missing_estimates(run: RecordedRun) -> str:
    """Return why no estimate was recorded, and what to do; empty where there is one."""
    sent, lost = (run.plant.get(name, 0) for name in ('samples_sent', 'samples_lost'))
    if lost == sent:
        return ('the estimator used no sample; expected an estimate for each, see the rejected '
                'samples in /diagnostics of the recording, and check joint and frame_id in '
                '--params')
    if len(run.series['stiffness']):
        return ''
    return (f'no estimate was recorded; expected one for each of {sent} samples, of which the '
            f'estimator answered {sent - lost}; the machine was too busy to connect the recorder '
            'in time: run the loop again, or longer')


def gap_explained(summary: Mapping[str, Any]) -> bool:
    """Return whether eq. (20) alone explains that the mean force is not the desired one."""
    mean, desired, law = (summary[name] for name in ('mean_force_n', 'desired_force_n',
                                                     'eq20_force_n'))
    if mean is None or desired is None or law is None:
        return False
    gap = abs(desired - mean)
    return bool(gap > _LEAST_GAP * desired and abs(mean - law) <= _EXPLAINED * gap)


def _eq20_force(run: RecordedRun, configuration: LoopConfiguration) -> float:
    """Return the force of eq. (20) under eq. (1) at rest; NaN for other laws."""
    K_t, K_e = configuration.plant.robot.stiffness, configuration.plant.environment.stiffness
    K_hat = _over_hold(run.series['stiffness'], configuration.experiment)
    if configuration.law != 'eq20' or not K_hat > 0.0:
        return nan
    return configuration.experiment.desired_force * K_t * K_e / (K_hat * (K_t + K_e))


def _over_hold(series: NDArray[np.float64], experiment: Experiment) -> float:
    """Average over the hold of every repetition."""
    hold = experiment.hold()
    if hold is None or not len(series):
        return nan
    phase = series[:, 0] % experiment.duration
    held = series[(phase >= hold[0]) & (phase < hold[1]), 1]
    return float(np.mean(held)) if len(held) else nan
