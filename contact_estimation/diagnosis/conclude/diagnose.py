# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The diagnosis: checks, comparison of models, names, held-out test, verdict."""

from __future__ import annotations

from dataclasses import replace
from typing import Sequence

import numpy as np

from .conclusion import conclude
from .next_experiment import diagnose_apart
from .result import Diagnosis, refuse
from .views import best_view, compare, Given, Progress, Seen
from ..checks import examine
from ..checks.experiment import with_places
from ..checks.stamps import with_offset
from ..fit.surfaces import surfaces_of
from ..observe.model import Model
from ..observe.observed import observe
from ..observe.parts import continuous_parts
from ..observe.prepared_recording import prepare
from ..observe.signals import Recording, with_reference_rates
from ..observe.usable_samples import held_at_rest, without_held_samples
from ...exceptions import ParameterRangeError
from ...plant.plant_parameters import PlantParameters

_FADES = 0.015  # of the speed of a motion: where dry friction fades, as 4e-4 of 0.027 m/s


def diagnose(
    recordings: Recording | Sequence[Recording], model: PlantParameters, *,
    held_out: Sequence[Recording] = (), seed: int = 0,
    progress: Progress = lambda text: None,
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
    _refuse_wrong_input(fitted, seed)
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
    nominal = _with_sharp_sign(nominal, [*fitted, *held_out])
    seen = best_view(Given(nominal, fitted, held_out, examined.checks), progress)
    if seen.view.offset is not None:
        commanded = all(one.observed.reference is not None for one in seen.recordings)
        return refuse(with_offset(examined.checks, *seen.view.offset, commanded), nominal)
    diagnosis = _with_words_of_surfaces(conclude(seen, seed, progress), seen)
    if diagnosis.verdict != 'unexplained':
        return diagnosis
    return _moving(seen, diagnosis, seed, progress)


def _with_sharp_sign(nominal: Model, recordings: Sequence[Recording]) -> Model:
    """Let dry friction fade at a speed far below those of the recordings."""
    known = nominal.nominal
    speeds = [np.sqrt(np.mean(observe(one.signals, known).v**2)) for one in recordings]
    width = min(known.sign_velocity, _FADES * float(min(speeds)))
    return replace(nominal, nominal=replace(known, sign_velocity=width))


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


def _refuse_wrong_input(
    recordings: Sequence[Recording], seed: int
) -> None:
    if not recordings:
        raise ParameterRangeError('recordings must hold at least one recording, got none')
    if seed < 0:
        raise ParameterRangeError(f'seed must be >= 0, got {seed}')
