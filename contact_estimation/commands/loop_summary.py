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

"""The figures of one run of the loop."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np

from .loop_run import LoopRun
from ..plant.plant_parameters import PlantParameters
from ..reference.experiment import Experiment


def summarise(
    run: LoopRun, plant: PlantParameters, experiment: Experiment, estimator: str, law: str
) -> dict[str, Any]:
    """
    Sum up a run as summary.json holds it.

    Parameters
    ----------
    run : LoopRun
        What was recorded.
    plant : PlantParameters
        The true world.
    experiment : Experiment
        What was played.
    estimator, law : str
        Names.

    Returns
    -------
    summary : dict
        As in the contract; null where a figure does not exist.

    """
    told = run.plant
    stamp = told.get('last_contact_stamp_ns')
    wall = plant.environment
    at = (stamp - told['begin_stamp_ns']) * 1e-9 if stamp else -1.0
    stiffness, damping = run.last_before('stiffness', at), run.last_before('damping', at)
    wanted = experiment.desired_force
    figures = {
        'estimator': estimator,
        'law': law,
        'stiffness': stiffness,
        'damping': damping,
        'stiffness_error_percent': 100.0 * (stiffness / wall.stiffness - 1.0),
        'damping_error_percent':
            100.0 * (damping / wall.damping - 1.0) if wall.damping > 0.0 else float('nan'),
        'mean_force_n': _mean_force(run, experiment),
        'desired_force_n': wanted,
        'rate_hz': told.get('rate_hz'),
        'samples_sent': told.get('samples_sent'),
        'samples_lost': told.get('samples_lost'),
        'latency_ms': told.get('latency_ms'),
    }
    return {name: _or_null(value) for name, value in figures.items()}


def _mean_force(run: LoopRun, experiment: Experiment) -> float:
    """Average the pressing force over the hold of every round that was played."""
    hold, force = experiment.hold(), run.series['force']
    if hold is None:
        return float('nan')
    phase = force[:, 0] % experiment.duration
    held = -force[(phase >= hold[0]) & (phase < hold[1]), 1]
    return float(np.mean(held)) if len(held) else float('nan')


def _or_null(value: Any) -> Any:
    return None if isinstance(value, float) and not isfinite(value) else value
