# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The recording of any simulator as the nominal model: its physics is identified first."""

from __future__ import annotations

from dataclasses import replace
from math import isnan, nan
from typing import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from .diagnose import diagnose
from .result import Diagnosis
from ..fit.free_run import plant_of
from ..observe.observed import observe, Observed
from ..observe.signals import Recording
from ...exceptions import RecordingError
from ...physics import effects_that_are_on
from ...plant.plant_parameters import PlantParameters, WallParameters

Array = NDArray[np.float64]

_PRESSING = 0.05  # of the largest force, from which on the wall is touched
_LEAST_MASS, _LEAST_SAMPLES = 1e-3, 20  # [kg]
_ROUNDS = 2  # the motion is smoothed around the free run of the robot that is found


def diagnose_simulation(
    simulation: Recording, start: PlantParameters | None = None, *, seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> tuple[PlantParameters, Diagnosis]:
    """
    Identify the model that a simulator ran, with names for what it has beyond eqs. (1) and (3).

    Parameters
    ----------
    simulation : Recording
        Of the simulator, under the commands of the real recordings.
    start : PlantParameters, optional
        What is known of the simulator; by default robot, wall and surface are estimated by least
        squares.
    seed, progress
        As of `diagnose`.

    Returns
    -------
    model : PlantParameters
        Nominal model for `diagnose`.
    found : Diagnosis
        What the simulator has beyond robot, spring and damper.

    Raises
    ------
    RecordingError
        If a check refuses the recording of the simulator.

    """
    found = diagnose(simulation, start or estimated_model(simulation), seed=seed,
                     progress=progress)
    if found.refused:
        raise RecordingError(
            f'the simulation {simulation.name} cannot be the nominal model: '
            + found.next_experiment)
    model = plant_of(found.corrected)
    return (model if start else _with_surface(model)), found


def _with_surface(model: PlantParameters) -> PlantParameters:
    """Move the surface by a named offset: where it was estimated, that is no physics."""
    shift = model.physics.contact_offset
    if isnan(shift.offset):
        return model
    physics = replace(model.physics, contact_offset=replace(shift, offset=nan))
    wall = replace(model.environment, location=model.environment.location + shift.offset)
    return replace(model, physics=physics, environment=wall)


def simulation_text(found: Diagnosis, model: PlantParameters) -> str:
    """Say in a line what was identified of a simulator."""
    wall, robot = model.environment, model.robot
    names = [effect.name.replace('_', ' ') for effect in effects_that_are_on(model.physics)]
    commanded = any(one.observed.reference is not None for one in found.recordings)
    robots = (f', M_t {robot.mass:.4g} kg, B_t {robot.damping:.4g} N s/m, '
              f'K_t {robot.stiffness:.4g} N/m') if commanded else ''
    doubt = 'no law explains all of it; ' if found.verdict == 'unexplained' else ''
    return (f'{doubt}K_e {wall.stiffness:.4g} N/m, '
            f'B_e {wall.damping:.4g} N s/m, x_e {wall.location:.4g} m{robots}; '
            + (f'it has {", ".join(names)}' if names else 'it has no physics beyond these'))


def estimated_model(recording: Recording) -> PlantParameters:
    """
    Estimate robot, wall and surface of a recording by least squares.

    -F_e = K_e (x - x_e) + B_e v while pressing; F_e = M_t (x'' - x_r'') + B_t (x' - x_r') +
    K_t (x - x_r), eq. (1).
    """
    model = PlantParameters()
    for _ in range(_ROUNDS):
        seen = observe(recording.signals, model)
        model = replace(model, environment=_wall(seen, recording.name, model))
        if seen.reference is None:
            break
        x_r, v_r, a_r, _ = seen.reference
        X = np.stack([seen.a - a_r, seen.v - v_r, seen.x - x_r], axis=1)
        size = np.sqrt(np.mean(X**2, axis=0)) + 1e-12
        M_t, B_t, K_t = (nnls(X / size, seen.force)[0] / size).tolist()
        model = replace(model, robot=replace(
            model.robot, mass=max(M_t, _LEAST_MASS), damping=B_t, stiffness=K_t))
    return model


def _wall(seen: Observed, name: str, model: PlantParameters) -> WallParameters:
    pressing = seen.measured & (seen.force < -_PRESSING * np.abs(seen.force).max())
    if np.count_nonzero(pressing) < _LEAST_SAMPLES:
        raise RecordingError(
            f'{name} must press on the wall for {_LEAST_SAMPLES} samples, got '
            f'{np.count_nonzero(pressing)}; check the sign of the force, or give --nominal')
    X = np.stack([seen.x, seen.v, np.ones(len(seen.t))], axis=1)[pressing]
    K_e, B_e, zero = np.linalg.lstsq(X, -seen.force[pressing], rcond=None)[0]
    if K_e <= 0.0:
        raise RecordingError(
            f'{name} must show a wall that resists more the deeper it is pressed, got '
            f'{K_e:.3g} N/m; check sign and axis, or give --nominal')
    return replace(model.environment, stiffness=float(K_e), damping=max(float(B_e), 0.0),
                   location=float(-zero / K_e))
