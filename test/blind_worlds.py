# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A small world, a truth and a report for the tests of blind_trials."""

from __future__ import annotations

from typing import Any

from contact_estimation.plant.plant_parameters import RobotParameters, WallParameters
from contact_estimation.reference.experiment import Experiment, Segment
from contact_estimation.studies.blind_trials.trial import Trial
from contact_estimation.studies.blind_trials.worlds import RandomWorld, Run, SensorModel
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WALL = WallParameters(stiffness=4000.0, damping=100.0)
ROBOT = RobotParameters(mass=20.0, damping=600.0, stiffness=4000.0)
EXPERIMENT = Experiment('short', -0.01, (
    Segment(0.3, -0.01), Segment(0.5, 0.03), Segment(0.6, 0.03), Segment(0.4, 0.02),
    Segment(0.5, 0.02), Segment(0.5, -0.01), Segment(0.3, -0.01),
))
WORLD = RandomWorld(WALL, ROBOT, SensorModel(), EXPERIMENT, 0.015)


def short_trial(effect: str = '', **values: float) -> Trial:
    """Return a trial of three seconds."""
    return Trial(WORLD, effect, values, WallParameters(stiffness=4400.0, damping=80.0), 1.0)


def synthetic_run(sensed: Array | None = None, count: int = 4000) -> Run:
    """Return sines in and out of the wall, with the force of a spring-damper."""
    t = np.arange(count) / 500.0
    d = 0.01 * np.sin(3.0 * t) + 0.004 * np.sin(11.0 * t)
    v = 0.03 * np.cos(3.0 * t) + 0.044 * np.cos(11.0 * t)
    force = np.where(d > 0.0, np.minimum(0.0, -4000.0 * d - 100.0 * v), 0.0)
    still = np.zeros(count)
    return Run(t, d, v, force, force if sensed is None else sensed, still, still, still)


def truth(effect: str = '', port: str = 'contact', **changes: Any) -> dict[str, Any]:
    """Return the content of a truth file."""
    parameters = changes.pop('parameters', {})
    effects = [{'name': effect, 'port': port, 'parameters': parameters}] if effect else []
    return {
        'effects': effects, 'verdict': 'physics_missing' if effect else 'recalibrate',
        'stiffness': 4000.0, 'damping': 100.0, 'concealed': 2.0, 'force_floor_n': 0.4,
        'experiment': 'rich', **changes}


def answer(*names: str, rivals: tuple[str, ...] = (), **changes: Any) -> dict[str, Any]:
    """Return the content of a report file."""
    parameters = changes.pop('parameters', {})
    effects = [{'name': name, 'probability': 0.95, 'indistinguishable_from': [],
                'parameters': {key: {'value': value} for key, value in parameters.items()}}
               for name in names]
    if effects:
        effects[0]['indistinguishable_from'] = list(rivals)
    report = {
        'verdict': 'physics_missing' if names else 'recalibrate', 'effects': effects,
        'corrected': {'stiffness': {'value': 4020.0}, 'damping': {'value': 98.0}}, **changes}
    return {'report': report, 'error': '', 'seconds': 1.0}
