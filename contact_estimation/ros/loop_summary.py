# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""The summary of one run of the loop."""

from __future__ import annotations

from math import inf, isfinite, nan
from typing import Any, Mapping

import numpy as np
from numpy.typing import NDArray

from .loop_configuration import LoopConfiguration
from .loop_run import RecordedRun
from ..reference.experiment import Experiment

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
        'mean_force_n': _mean_force(run, configuration.experiment),
        'desired_force_n': configuration.experiment.desired_force,
        'eq20_force_n': _eq20_force(run, configuration),
        'model_fit': run.last_before('model_fit', inf),
        'model_fit_worst': _greatest(run.series['model_fit'][:, 1]),
        **{name: measured.get(name)
           for name in ('rate_hz', 'samples_sent', 'samples_lost', 'latency_ms')},
    }
    summary = {name: _or_none(value) for name, value in values.items()}
    disturbed = disturbances(measured, configuration.plant.sample_rate)
    return {**summary, 'disturbed': disturbed}


def disturbances(measured: Mapping[str, Any], sample_rate: float) -> list[str]:
    """
    Return why a run does not show what the estimator does on an idle machine.

    sample_rate: of the plant [Hz]
    """
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


def _mean_force(run: RecordedRun, experiment: Experiment) -> float:
    """Average the pressing force over the hold of every repetition."""
    return -_over_hold(run.series['force'], experiment)


def _over_hold(series: NDArray[np.float64], experiment: Experiment) -> float:
    hold = experiment.hold()
    if hold is None or not len(series):
        return nan
    phase = series[:, 0] % experiment.duration
    held = series[(phase >= hold[0]) & (phase < hold[1]), 1]
    return float(np.mean(held)) if len(held) else nan


def _greatest(values: NDArray[np.float64]) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if len(known) else nan


def _or_none(value: Any) -> Any:
    return None if isinstance(value, float) and not isfinite(value) else value
