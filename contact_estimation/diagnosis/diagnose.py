# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The diagnosis of a nominal model, or of the physics that any simulator's recording shows."""

from dataclasses import replace
from math import isnan, nan
from typing import Callable, Sequence

import numpy as np
from scipy.optimize import nnls

from .checks import examine
from .checks.check import of_families
from .checks.experiment import with_places
from .checks.stamps import with_offset
from .conclusion import conclude
from .fit.free_run import plant_of
from .fit.surfaces import surfaces_of
from .next_experiment import diagnose_apart
from .observe.model import Model, Unit
from .observe.observed import observe, Observed
from .observe.parts import continuous_parts
from .observe.prepared_recording import prepare
from .observe.shares import LITTLE
from .observe.signals import Recording, with_reference_rates
from .observe.usable_samples import held_at_rest, without_held_samples
from .result import Diagnosis, refuse
from .stamp_offset import Offset
from .views import best_view, CAUSED, compare, Given, Progress, Seen
from ..exceptions import ParameterRangeError, RecordingError
from ..physics import effects_that_are_on
from ..plant.plant_parameters import PlantParameters, WallParameters

_FADES = 0.015  # of the speed of a motion: where dry friction fades at most, as 4e-4 of 0.027 m/s


def diagnose(
    recordings: Recording | Sequence[Recording], model: PlantParameters, *,
    held_out: Sequence[Recording] = (), seed: int = 0, progress: Progress = lambda text: None,
) -> Diagnosis:
    """
    Compare recordings with the model that simulates them, and name the physics it lacks.

    Parameters
    ----------
    recordings : Recording or sequence of Recording
        From `read_recording`; several are fitted together.
    model : PlantParameters
        Nominal model, from `read_model`; its physics, if any, are recalibrated as K_e and B_e
        are, and names are what lacks beyond.
    held_out : sequence of Recording
        Recordings that are excluded from fitting; without any, a part of each recording is.
    seed : int
        Seed of the bootstraps, >= 0.
    progress : callable
        Called with a description of each stage.

    Returns
    -------
    diagnosis : Diagnosis
        `verdict`, `effects` with fitted parameters, `stiffness`, `damping` and held-out errors.

    Raises
    ------
    ParameterRangeError
        If there is no recording or `seed` is negative.
    RecordingError
        If a recording has too little data, no contact or a constant signal.

    """
    fitted = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not fitted:
        raise ParameterRangeError('recordings must hold at least one recording, got none')
    if seed < 0:
        raise ParameterRangeError(f'seed must be >= 0, got {seed}')
    progress('checks')
    fitted, held_out = ([without_held_samples(one) for one in every]
                        for every in (fitted, held_out))
    examined = examine([*fitted, *held_out], model, len(fitted))
    nominal = Model.of(model, examined.excluded)
    if examined.refused:
        return refuse(examined.checks, nominal)
    every = [with_reference_rates(one) for one in examined.recordings]
    fitted, held_out = (
        [part for one in some for part in continuous_parts(one, model)]
        for some in (every[:len(fitted)], every[len(fitted):]))
    nominal = _in_scales_of([*fitted, *held_out], nominal)
    seen = best_view(Given(nominal, fitted, held_out, examined.checks), progress)
    if seen.view.offset is not None:
        return _beside_offset(seen, seen.view.offset, seed, progress)
    diagnosis = _with_words_of_surfaces(conclude(seen, seed, progress), seen)
    if diagnosis.verdict != 'unexplained':
        return diagnosis
    return _moving(seen, diagnosis, seed, progress)


def _beside_offset(seen: Seen, offset: Offset, seed: int, progress: Progress) -> Diagnosis:
    """Name what stamps that are off do not look like; refuse recordings without such a law."""
    commanded = all(one.observed.reference is not None for one in seen.recordings)
    given, known = seen.view.given, seen.compared
    unlike = [one for one in known.models if not one.named & CAUSED]
    if unlike[0].laws:
        checks = with_offset(given.checks, *offset, commanded, of_families(*CAUSED))
        view = seen.view._replace(given=given._replace(checks=checks))
        found = conclude(
            seen._replace(view=view, compared=known._replace(models=unlike)), seed, progress)
        if found.effects:
            return found
    return refuse(with_offset(given.checks, *offset, commanded), given.nominal)


def _in_scales_of(recordings: Sequence[Recording], nominal: Model) -> Model:
    """Let values of 0 have sizes, and dry friction fade at a speed, in scales of recordings."""
    known, seen = nominal.nominal, [observe(one.signals, nominal.nominal) for one in recordings]
    speeds = [float(np.sqrt(np.mean(one.v**2))) for one in seen]
    given, most = known.sign_velocity, _FADES * min(speeds)
    width = given if LITTLE * most < given < most else most  # a sharper one is in other units
    length = max(float(np.ptp(one.x)) for one in seen)
    unit = Unit(length, max(float(np.ptp(one.force)) for one in seen), length / max(speeds))
    return replace(nominal, nominal=replace(known, sign_velocity=width), unit=unit)


def _moving(seen: Seen, diagnosis: Diagnosis, seed: int, progress: Progress) -> Diagnosis:
    """Diagnose without the rests of a drive where they hide what is missing while it moves."""
    given = seen.view.given
    if given.nominal.nominal.environment.unilateral or all(
            held_at_rest(given.nominal, one.observed) is None for one in seen.recordings):
        return diagnosis
    moving = given.with_each(lambda one: replace(one, rests_count=False))
    view = seen.view._replace(given=moving, moving=True)
    other = conclude(compare(view, progress), seed, progress)
    return other if other.verdict == 'physics_missing' else diagnosis


def _with_words_of_surfaces(diagnosis: Diagnosis, seen: Seen) -> Diagnosis:
    """Say where contacts begin if at different places, or that each has a wall of its own."""
    given = seen.view.given
    if seen.view.places:
        return replace(diagnosis, checks=with_places(given.checks, seen.view.places))
    if diagnosis.effects or diagnosis.verdict != 'unexplained' or (
            not given.nominal.nominal.environment.unilateral):
        return diagnosis
    surfaces = surfaces_of([prepare(one, given.nominal, hold=False)
                            for one in (*given.fitted, *given.held_out)])
    if not surfaces.are_of_several:
        return diagnosis
    return replace(diagnosis, next_experiment=diagnose_apart(surfaces.springs))


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
    model = start or _with_free_surface(estimated_model(simulation))
    found = diagnose(replace(simulation, simulated=True), model, seed=seed, progress=progress)
    if found.refused:
        raise RecordingError(
            f'the simulation {simulation.name} cannot be the nominal model: '
            + found.next_experiment)
    model = plant_of(found.corrected)
    return (model if start else _with_surface(model)), found


_LITTLE_M = 1e-6  # an offset of 0 would be none


def _with_free_surface(model: PlantParameters) -> PlantParameters:
    """Let the surface be fitted again beside every law: that of the spring alone is off."""
    offset = replace(model.physics.contact_offset, offset=_LITTLE_M)
    return replace(model, physics=replace(model.physics, contact_offset=offset))


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
    """Estimate robot, wall and surface of a recording by least squares."""
    # -F_e = K_e (x - x_e) + B_e v while pressing; F_e = M_t (x'' - x_r'') + B_t (x' - x_r') +
    # K_t (x - x_r), eq. (1).
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
