# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Ground truth of a trial, in the form of the truth file."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from .concealment import degree
from .measurement import TRUTH_HZ
from .simulation import Run, simulate
from .trial import Trial
from ...physics import EFFECTS


def ground_truth(trial: Trial, run: Run, force_floor: float) -> dict[str, Any]:
    """
    Collect the ground truth of a trial.

    force_floor: RMS of the recorded force noise [N]
    """
    world, effect = trial.world, EFFECTS.get(trial.effect)
    effects = [] if effect is None else [
        {'name': trial.effect, 'port': trial.port, 'parameters': dict(trial.values)}]
    clean_verdict = 'consistent' if trial.is_exact else 'recalibrate'
    return {
        'effects': effects,
        'verdict': 'physics_missing' if effects else clean_verdict,
        'stiffness': (
            None if getattr(effect, 'replaces_stiffness', False) else world.wall.stiffness),
        'damping': 0.0 if getattr(effect, 'replaces_damping', False) else world.wall.damping,
        'concealed': _degree(trial, run),
        'force_floor_n': force_floor,
        'experiment': world.experiment.name,
        'sensing': asdict(world.sensors),
    }


def _degree(trial: Trial, run: Run) -> float:
    """Compute the degree of concealment of the final simulation."""
    if not trial.effect:
        return 1.0
    world = trial.world
    without = simulate(world, {}, world.sensors.rate)
    return degree(EFFECTS[trial.effect].needs_robot, world, _at_sample_rate(trial, run), without)


def _at_sample_rate(trial: Trial, run: Run) -> Run:
    every = round(TRUTH_HZ / trial.world.sensors.rate)
    return Run(*(signal[::every] for signal in run))
