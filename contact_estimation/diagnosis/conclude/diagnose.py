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

"""The diagnosis: noise, recalibration, selection of effects, held-out test, verdict."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, Sequence

import numpy as np

from .conclusion import conclude, Fitted
from .refusal import refuse
from .result import Diagnosis
from .second_look import at_the_surfaces, Given, without_rests
from ..checks import examine
from ..checks.stamps import with_offset
from ..fit.clocks import Clocks, Offset
from ..fit.criteria import penalty, SHARE, THRESHOLD
from ..fit.discrepancy import has_discrepancy
from ..fit.fitting import cost_of, Fit, fit
from ..fit.free_run import free_run
from ..fit.model_uncertainty import discounted
from ..fit.order import ranked_by
from ..fit.reference_hold import ReferenceHold
from ..fit.ripple import without_ripple
from ..fit.same_effects import fitted_again, of_model, with_effects_kept
from ..fit.search import Progress
from ..fit.selection import select, Selection
from ..observe.held_reference import with_held_reference
from ..observe.held_samples import without_held_samples
from ..observe.model import Model
from ..observe.observed import observe
from ..observe.parts import continuous_parts
from ..observe.prepared_recording import prepare, PreparedRecording, Recordings
from ..observe.reference_rates import with_reference_rates
from ..observe.residuals import force_residual
from ..observe.signals import Recording
from ...exceptions import ModelFileError, ParameterRangeError
from ...physics import effects_that_are_on
from ...plant.between_samples import BETWEEN
from ...plant.plant_parameters import PlantParameters

_DIVERGED = 1e3  # times the range of the motion
_SHARPER = 0.7  # of the cost: less may show that the law is exact
_UNCHANGED = 0.02  # of the misfit: best model after smoothing again
_SHOWN = 0.6  # of the error on what is fitted: less on the held-out part tells nothing of a name


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
        Nominal model, from `read_model`, without extra physics.
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
    ModelFileError
        If the model already has extra physics.
    ParameterRangeError
        If there is no recording or `seed` is negative.
    RecordingError
        If a recording has too little data, no contact or a constant signal.

    """
    fitted = [recordings] if isinstance(recordings, Recording) else list(recordings)
    _refuse_wrong_input(fitted, model, seed)
    progress('checks')
    fitted, held_out = ([without_held_samples(one) for one in every]
                        for every in (fitted, held_out))
    examined = examine([*fitted, *held_out], model, len(fitted))
    nominal = Model.of(model, examined.excluded)
    if examined.refused:
        return refuse(examined.checks, nominal)
    fitted, held_out = (examined.recordings[:len(fitted)], examined.recordings[len(fitted):])
    fitted, held_out = ([with_reference_rates(one) for one in every]
                        for every in (fitted, held_out))
    fitted = [part for one in fitted for part in continuous_parts(one, model)]
    held_out = [part for one in held_out for part in continuous_parts(one, model)]
    given = Given(nominal, fitted, held_out, examined.checks, seed, progress)
    diagnosis = _with_the_best_held_out(given)
    if diagnosis.refused:
        return diagnosis
    look_again = at_the_surfaces if model.environment.unilateral else without_rests
    return look_again(given, diagnosis, _with_the_best_held_out)


def _with_the_best_held_out(given: Given) -> Diagnosis:
    """Diagnose; hold out other parts where the first do not show what is missing."""
    if given.held_out:
        return _diagnosed(given, hold=0)[0]
    diagnosis, shows_alike = _diagnosed(given, hold=1)
    if diagnosis.verdict != 'unexplained' or diagnosis.effects or shows_alike:
        return diagnosis
    other, _ = _diagnosed(given, hold=2)
    return other if other.effects else diagnosis


def _diagnosed(given: Given, hold: int) -> tuple[Diagnosis, bool]:
    """
    Diagnose with a certain part held out.

    Returns
    -------
    diagnosis : Diagnosis
        The result.
    shows_alike : bool
        Whether the recalibrated model leaves more than noise of what it is fitted on, and of what
        is held out about as much: else this can neither confirm nor contradict a name.

    """
    nominal, progress = given.nominal, given.progress
    progress('noise and alignment')
    found = _selected(given.fitted, given.held_out, nominal, hold, progress)
    prepared, selection = found.prepared, found.selection
    if found.offset is not None:
        commanded = all(one.observed.reference is not None for one in prepared)
        return refuse(with_offset(given.checks, *found.offset, commanded), nominal), True
    others: Recordings = [prepare(one, nominal, hold=0) for one in found.held_out]
    nominal_cost = cost_of(prepared, nominal)
    if all(one.driven_by_force(nominal) for one in prepared):
        between = _likeliest_between_samples(selection.recordings, selection)
        if between != prepared[0].observed.between:
            others = [one.with_force_between_samples(between, nominal) for one in others]
            prepared, selection = _with_force_between_samples(
                between, prepared, selection, nominal, progress)
            nominal_cost = cost_of(prepared, nominal)
    selection = _smooth_again(found.fitted, prepared, selection, nominal, progress)

    def concluded(selected: Selection) -> Diagnosis:
        # The largest misfit first: that recording is located and shown.
        largest = ranked_by(selected.recordings, lambda one: -cost_of([one], selected.base.model)
                            / one.residual_count)
        fits = Fitted(nominal, nominal_cost, selected._replace(recordings=largest), others)
        return replace(conclude(fits, given.seed, progress), checks=given.checks,
                       holds_reference=found.holds_reference)

    diagnosis = concluded(selection)
    shows = ((bool(selection.best.model.effects) or has_discrepancy(selection.recordings))
             and _shows_there(selection, diagnosis))
    if _refuted(selection, diagnosis):
        by_prediction = concluded(
            select(selection.recordings, selection.base, progress, by_likelihood=False))
        return by_prediction if by_prediction.effects else diagnosis, shows
    return diagnosis, shows


def _shows_there(selection: Selection, diagnosis: Diagnosis) -> bool:
    """Return whether the held-out part shows a fair share of the misfit of what is fitted."""
    there = diagnosis.force.recalibrated
    fitted = np.concatenate([force_residual(one, selection.base.model)[one.force.use]
                             for one in selection.recordings])
    return there is None or there > _SHOWN * float(np.sqrt(np.mean(fitted**2)))


def _refuted(selection: Selection, diagnosis: Diagnosis) -> bool:
    """Return whether laws that fit down to the noise fail on parts left out of the fit."""
    likely = selection.best.model.effects and not has_discrepancy(selection.recordings)
    return bool(likely) and not diagnosis.effects and diagnosis.verdict == 'unexplained'


def _refuse_wrong_input(
    recordings: Sequence[Recording], model: PlantParameters, seed: int
) -> None:
    if not recordings:
        raise ParameterRangeError('recordings must hold at least one recording, got none')
    if seed < 0:
        raise ParameterRangeError(f'seed must be >= 0, got {seed}')
    named = [effect.name for effect in effects_that_are_on(model.physics)]
    if named:
        raise ModelFileError(
            f'the nominal model must have no physics, got {", ".join(named)}; remove it: '
            'diagnose names the physics that a model without any lacks'
        )


class _Selected(NamedTuple):
    """
    Recordings as fitted and held out, prepared, and the effects that they ask for.

    Attributes
    ----------
    holds_reference : bool
        Whether the robot holds the reference between setpoints.
    offset : Offset or None
        Of a topic whose stamps differ from those of the others.

    """

    fitted: Sequence[Recording]
    held_out: Sequence[Recording]
    prepared: Recordings
    selection: Selection
    holds_reference: bool = False
    offset: Offset | None = None


def _selected(
    fitted: Sequence[Recording], held_out: Sequence[Recording], nominal: Model, hold: int,
    progress: Progress,
) -> _Selected:
    """Select the effects, with the reference as the robot seems to follow it."""
    def recalibrated(raw: Sequence[Recording]) -> tuple[Recordings, Fit]:
        prepared: Recordings = [prepare(one, nominal, hold=hold) for one in raw]
        progress('recalibration')
        return _recalibrate(prepared, nominal)

    def selected(raw: Sequence[Recording]) -> tuple[Recordings, Selection]:
        prepared, base = recalibrated(raw)
        return prepared, select(prepared, base, progress)

    straight = _Selected(fitted, held_out, *selected(fitted))
    best = straight.selection.best.model
    if not all(one.observed.has_dynamics(nominal.nominal) for one in straight.prepared):
        return straight
    progress('clocks of the topics')
    offset = Clocks(fitted, straight.prepared, straight.selection.base.model, best,
                    hold).offset(selected)
    if offset is not None:
        return straight._replace(offset=offset)
    if any(one.observed.reference is None for one in straight.prepared):
        return straight
    progress('reference between setpoints')
    held = [with_held_reference(one) for one in fitted]
    holding = ReferenceHold(straight.prepared, fitted, held, straight.selection.base.model)
    if not holding.is_promising(best):
        return straight
    prepared, base = recalibrated(held)
    kept = with_effects_kept(prepared, base, straight.selection, holding.leaves_alike(best))
    selection = kept or select(prepared, base, progress)
    if not holding.is_better(selection.best.model, best):
        without = holding.instead_of_delay(best)
        if without is None:
            return straight
        selection = of_model(prepared, selection, without)
    return _Selected(held, [with_held_reference(one) for one in held_out], prepared, selection,
                     holds_reference=True)


def _recalibrate(recordings: Recordings, model: Model) -> tuple[Recordings, Fit]:
    """Fit a model, then discount the model uncertainty there and fit it again."""
    rough = fit(recordings, model)
    recordings = [without_ripple(one, rough.model) for one in recordings]
    recordings = [discounted(one, rough.model) for one in recordings]
    return recordings, fit(recordings, rough.model)


def _likeliest_between_samples(recordings: Recordings, selection: Selection) -> str:
    """Return the course of the force between samples, of `BETWEEN`, with the fewest effects."""
    base, best, costs = fit(recordings, selection.base.model), fit(
        recordings, selection.best.model), dict[str, float]()
    for name in BETWEEN:
        changed = [one.with_force_between_samples(name, base.model) for one in recordings]
        fits = [fit(changed, found.model) for found in (base, best)]
        costs[name] = min(found.cost + penalty(found.model) for found in fits)
    likeliest = next(iter(BETWEEN))
    least = SHARE * max(costs[likeliest] - best.residual_count, 0.0)
    costs[likeliest] -= max(THRESHOLD * best.residual_count, least)
    return ranked_by(costs, lambda name: costs[name])[0]


def _with_force_between_samples(
    between: str, before: Recordings, selection: Selection, model: Model, progress: Progress
) -> tuple[Recordings, Selection]:
    """Prepare recordings with another course of the force; select again if that tells more."""
    changed: Recordings = [one.with_force_between_samples(between, model) for one in before]
    changed, base = _recalibrate(changed, model)
    carried, best = selection.recordings, selection.best
    if has_discrepancy(carried):
        again = [one.with_force_between_samples(between, model) for one in carried]
        if fit(again, best.model).cost > _SHARPER * best.cost:
            return changed, fitted_again(changed, selection)
    return changed, select(changed, base, progress)


def _smooth_again(
    raw: Sequence[Recording], recordings: Recordings, selection: Selection, model: Model,
    progress: Progress,
) -> Selection:
    """
    Smooth the motion with the selected model, and fit or select again.

    The free run of a good model follows the sharp bends of the motion, so that the difference
    needs less bandwidth and velocities get more accurate; friction near standstill needs that.
    """
    best = selection.best.model
    runs = all(one.observed.has_dynamics(model.nominal) for one in recordings)
    if not best.effects or not runs:
        return selection
    progress('smoothing with the selected model')
    again = _smoothed_with(best, raw, recordings, model)
    if again is None:
        return selection
    again, base = _recalibrate(again, selection.base.model)
    named = fit(again, best)
    if has_discrepancy(selection.recordings):  # sharper motion may show that the law is exact
        before = fit(recordings, best).cost
        return select(again, base, progress) if named.cost < _SHARPER * before else selection
    if named.cost > selection.best.cost or not named.model.plausible():
        return selection
    left = named.cost - named.residual_count
    if left > max(0.5 * THRESHOLD * named.residual_count,
                  _UNCHANGED * (base.cost - base.residual_count)):
        return select(again, base, progress)
    return selection._replace(recordings=again, base=base, best=named)


def _smoothed_with(
    best: Model, raw: Sequence[Recording], recordings: Recordings, model: Model
) -> Recordings | None:
    """Smooth with the free run of a model; None if it diverges or needs more bandwidth."""
    again = []
    for signals, one in zip((recording.signals for recording in raw), recordings):
        o = one.observed
        carried = free_run(best, o).position
        largest = _DIVERGED * np.max(np.abs(o.x))
        if not np.isfinite(carried).all() or np.max(np.abs(carried)) > largest:
            return None
        better = replace(observe(signals, model.nominal, carried, o.between), held=o.held)
        if better.cutoff > o.cutoff:
            return None
        again.append(PreparedRecording.of(one.name, better, model, one.held_out))
    return again
