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


"""The summary of one run of the loop."""

from __future__ import annotations

from math import inf, isfinite, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .loop_configuration import LoopConfiguration
from .loop_run import RecordedRun
from ..reference.experiment import Experiment


def summarise(run: RecordedRun, configuration: LoopConfiguration) -> dict[str, Any]:
    """
    Return the content of summary.json.

    Parameters
    ----------
    run : RecordedRun
        What was recorded.
    configuration : LoopConfiguration
        What was run, including the true wall.

    Returns
    -------
    summary : dict
        Estimates at the last instant of contact, mean force over the hold, and what the plant
        measured; None where a value does not exist.

    """
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
        'model_fit': run.last_before('model_fit', inf),
        'model_fit_worst': _greatest(run.series['model_fit'][:, 1]),
        **{name: measured.get(name)
           for name in ('rate_hz', 'samples_sent', 'samples_lost', 'latency_ms')},
    }
    return {name: _or_none(value) for name, value in values.items()}


def _mean_force(run: RecordedRun, experiment: Experiment) -> float:
    """Average the pressing force over the hold of every repetition."""
    hold, force = experiment.hold(), run.series['force']
    if hold is None:
        return nan
    phase = force[:, 0] % experiment.duration
    held = -force[(phase >= hold[0]) & (phase < hold[1]), 1]
    return float(np.mean(held)) if len(held) else nan


def _greatest(values: NDArray[np.float64]) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if len(known) else nan


def _or_none(value: Any) -> Any:
    return None if isinstance(value, float) and not isfinite(value) else value
