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

"""From a selection of effects to the result: decision, refinement, held-out errors, names."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .decision import decide, Decision, verdict_of
from .dependence import dependences
from .held_out import by_part, errors_of, improvement_interval, measure_part, Part
from .location import locate, Location
from .naming import advice, name_effects
from .result import Diagnosis, NamedEffect, pair_of, Value
from ..fit.fitting import Fit
from ..fit.free_run import free_run
from ..fit.model_uncertainty import discounted
from ..fit.output_error import refine, refine_and_prune
from ..fit.search import Progress
from ..fit.selection import Selection
from ..fit.uncertainty import standard_deviations
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings

Array = NDArray[np.float64]

MODELS = ('nominal', 'recalibrated', 'corrected')


class Fitted(NamedTuple):
    """
    The results of all fits, from which `conclude` decides.

    Attributes
    ----------
    nominal : Model
        The model under diagnosis.
    nominal_cost : float
        Its cost.
    selection : Selection
        Recalibrated model, model with effects, and their rivals.
    recordings : sequence of PreparedRecording
        As fitted; the first is located and shown.
    holdouts : sequence of PreparedRecording
        Held-out recordings.
    odd_robot : bool
        Whether the motion misfit was treated as noise, because no effect explains it.

    """

    nominal: Model
    nominal_cost: float
    selection: Selection
    recordings: Recordings
    holdouts: Recordings
    odd_robot: bool


def conclude(fitted: Fitted, seed: int, progress: Progress) -> Diagnosis:
    """
    Decide on the names and test the models on held-out data.

    Parameters
    ----------
    fitted : Fitted
        The outcome of all fitting.
    seed : int
        Of the bootstraps.
    progress : callable
        Called with a description of each stage.

    Returns
    -------
    diagnosis : Diagnosis
        The result.

    """
    generator, selection = np.random.default_rng(seed), fitted.selection
    whole = [discounted(one.whole(selection.base.model), selection.base.model)
             for one in fitted.recordings]
    decision = decide(selection, fitted.recordings, whole, fitted.odd_robot, progress)
    verdict = verdict_of(decision, selection.base, fitted.nominal_cost)
    recordings, base, best = _refined(fitted, decision, progress)
    progress('held-out parts')
    models = (fitted.nominal, base.model, best.model)
    parts, free_runs = _held_out(recordings, whole, fitted.holdouts, models)
    stds = standard_deviations(recordings, best)
    names = name_effects(best, stds, selection, recordings, whole[0], generator)
    location = _locate(fitted, verdict, names.effects, base, best, whole[0])
    improvement = improvement_interval(parts, generator)
    progress('dependence of the residuals')
    by_name = dict(zip(MODELS, models))
    force, motion = errors_of(parts)
    return Diagnosis(
        verdict=verdict, effects=names.effects, location=location, nominal=models[0],
        recalibrated=models[1], corrected=models[2],
        stiffness=Value(best.model.stiffness, stds[0], 'N/m'),
        damping=Value(best.model.damping, stds[1], 'N s/m'),
        noise_floor=float(np.mean([one.force_noise for one in recordings])),
        force=force, motion=motion, improvement=improvement, holdouts=by_part(parts),
        next_experiment=advice(names.effects, verdict), rivals=names.rivals,
        evidence=selection.evidence, residual_power=best.cost / best.residual_count,
        predictable=decision.predictable,
        dependences={name: dependences(whole[0], by_name[name], generator)
                     for name in pair_of(bool(names.effects))},
        recordings=recordings, free_runs=free_runs,
    )


def _refined(
    fitted: Fitted, decision: Decision, progress: Progress
) -> tuple[Recordings, Fit, Fit]:
    """Minimise the output error of an explained recording; return base and best model."""
    recordings, base, best = fitted.recordings, fitted.selection.base, decision.best
    if decision.unexplained or not all(
            one.observed.has_dynamics(fitted.nominal.nominal) for one in recordings):
        return recordings, base, best
    progress('output error')
    if best.model.effects:
        recordings, best = refine_and_prune(recordings, best)
        return recordings, base, best
    recordings, base = refine(recordings, base)
    return recordings, base, base


def _locate(
    fitted: Fitted, verdict: str, names: Sequence[NamedEffect], base: Fit, best: Fit,
    shown: PreparedRecording,
) -> Location | None:
    """Locate what is missing, or what is still missing beside the names."""
    if verdict not in ('physics_missing', 'unexplained'):
        return None
    beside = verdict == 'unexplained' and bool(best.model.effects)
    port = names[0].port if names and not beside else None
    if fitted.odd_robot:  # its misfit is not taken for noise here
        shown = discounted(replace(shown, motion_misfit=1.0), fitted.selection.base.model)
        port = 'robot'
    return locate(shown, (best if beside else base).model, port)


def _held_out(
    recordings: Recordings, whole: Recordings, holdouts: Recordings, models: Sequence[Model]
) -> tuple[list[Part], dict[str, Array]]:
    """Measure the held-out parts; return also the free runs of the first recording."""
    parts: list[Part] = []
    runs = [_free_runs(one, models) for one in recordings]
    for one, all_of_it, positions in zip(recordings, whole, runs):
        if one.held_out is not None:
            prefix = f'{one.name}, ' if len(recordings) > 1 else ''
            parts.append(measure_part(
                prefix + one.held_out.name, all_of_it, one.held_out.samples, models, positions))
    for one in holdouts:
        everything = np.ones(len(one.observed.t), bool)
        parts.append(measure_part(one.name, one, everything, models, _free_runs(one, models)))
    return parts, dict(zip(MODELS, runs[0] or ()))


def _free_runs(recording: PreparedRecording, models: Sequence[Model]) -> list[Array] | None:
    """Return the free-run positions of the models; None without dynamics."""
    if not recording.observed.has_dynamics(models[0].nominal):
        return None
    nominal, recalibrated = (free_run(one, recording.observed).position for one in models[:2])
    if models[2] is models[1]:
        return [nominal, recalibrated, recalibrated]
    return [nominal, recalibrated, free_run(models[2], recording.observed).position]
