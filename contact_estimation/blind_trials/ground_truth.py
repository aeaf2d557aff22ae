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

"""Ground truth of a trial, in the form of the truth file."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from .concealment import active_intervals, degree, residual
from .measurement import TRUTH_HZ
from .simulation import Run, simulate
from .trial import Trial
from .unknown_effects import make_unknown, UNKNOWN
from ..physics import EFFECTS
from ..physics.robot_effect import RobotEffect


def ground_truth(trial: Trial, run: Run, force_floor: float) -> dict[str, Any]:
    """
    Collect the ground truth of a trial.

    Parameters
    ----------
    trial : Trial
        The trial.
    run : Run
        Its simulation at TRUTH_HZ.
    force_floor : float
        RMS of the recorded force noise [N].

    Returns
    -------
    truth : dict
        Effects, verdict, wall, degree of concealment and sensor model, ready for JSON.

    """
    world, effect = trial.world, EFFECTS.get(trial.effect)
    effects = [_description(trial)] if effect else []
    unknown = _unknown(trial, run) if trial.effect in UNKNOWN else None
    clean_verdict = 'consistent' if trial.is_exact else 'recalibrate'
    return {
        'effects': effects,
        'unknown': unknown,
        'verdict': 'physics_missing' if effects else 'unexplained' if unknown else clean_verdict,
        'stiffness': (
            None if getattr(effect, 'replaces_stiffness', False) else world.wall.stiffness),
        'damping': 0.0 if getattr(effect, 'replaces_damping', False) else world.wall.damping,
        'concealed': _degree(trial, run),
        'force_floor_n': force_floor,
        'experiment': world.experiment.name,
        'sensing': asdict(world.sensors),
    }


def _description(trial: Trial) -> dict[str, Any]:
    return {'name': trial.effect, 'port': trial.port, 'parameters': dict(trial.values)}


def _unknown(trial: Trial, run: Run) -> dict[str, Any]:
    """Describe an effect outside the library, with the intervals in which it acts."""
    sampled = _at_sample_rate(trial, run)
    effect = make_unknown(trial.effect, trial.values)
    # The drag of a robot effect is known exactly; its residual is dominated by impacts.
    shown = (np.asarray(effect.drag(sampled.v, np)) if isinstance(effect, RobotEffect)
             else residual(trial.port, trial.world, sampled))
    first, last = trial.values.get('first', 0.0), trial.values.get('last', np.inf)
    shown = np.where((sampled.t >= first) & (sampled.t <= last), shown, 0.0)
    return {**_description(trial), 'intervals_s': active_intervals(shown, sampled.t)}


def _degree(trial: Trial, run: Run) -> float:
    """Compute the degree of concealment of the final simulation."""
    if not trial.effect:
        return 1.0
    world = trial.world
    without = simulate(world, {}, world.sensors.rate)
    return degree(trial.port, world, _at_sample_rate(trial, run), without)


def _at_sample_rate(trial: Trial, run: Run) -> Run:
    every = round(TRUTH_HZ / trial.world.sensors.rate)
    return Run(*(signal[::every] for signal in run))
