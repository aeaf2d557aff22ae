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

from math import prod
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .alternatives import alternatives
from .decision import decide, decide_on_rest, Decision, verdict_of
from .dependence import dependences
from .held_out import by_part, errors_of, improvement_interval, measure_part, Part
from .location import locate, Location
from .naming import advice, name_effects, Names
from .result import Diagnosis, Errors, NamedEffect, pair_of, Remainder, Value
from .shares import Shares
from ..fit.applicable import has_paces
from ..fit.criteria import explained_share
from ..fit.discrepancy import has_discrepancy, least_material
from ..fit.fitting import Fit, fit_at
from ..fit.free_run import free_run
from ..fit.model_uncertainty import discounted
from ..fit.output_error import refine, refine_and_prune
from ..fit.search import Progress
from ..fit.selection import Selection
from ..fit.uncertainty import standard_deviations
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings
from ...physics import EFFECTS

Array = NDArray[np.float64]

# Ratios of errors on held-out data.
_PROMISED, _SHOWN = 0.8, 0.3  # shares explained: of all parts, at least of the held-out ones
_ABOVE_NOISE = 1.4  # times the noise: the held-out force, to show anything
_CLEARLY_WORSE, _MUCH_WORSE, _FAR_WORSE, _THE_SAME = 1.05, 1.5, 3.0, 1.02
_UNTOLD = 4.0  # cost of two standard deviations
_HELD = 0.3  # deviation of a spring's force, in that of all the force, which holds a driven mass
_DAMPED = 0.5  # deviation of the force of the damper, in that of all the force
_NOTHING = 0.01  # of the misfit: a remainder that is not worth a word

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
        Recalibrated model, model with effects, and their rivals; of its recordings the first is
        located and shown.
    holdouts : sequence of PreparedRecording
        Held-out recordings.

    """

    nominal: Model
    nominal_cost: float
    selection: Selection
    holdouts: Recordings


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
    generator, base_model = np.random.default_rng(seed), fitted.selection.base.model
    whole = [discounted(one.whole(base_model), base_model)
             for one in fitted.selection.recordings]
    tested = _decided(fitted, whole, progress)
    names = _named(tested, whole, generator)
    while unlikely := names.unlikely:
        rest = decide_on_rest(
            tested.decision.selection, tested.decision.best.model, unlikely, whole, progress)
        tested = _tested(fitted, whole, rest, progress)
        names = _named(tested, whole, generator)
    decision, recordings, base, best, parts, free_runs, _ = tested
    selection, models = decision.selection, (fitted.nominal, base.model, best.model)
    force, motion = errors_of(parts)
    verdict = verdict_of(decision, selection.base, fitted.nominal_cost)
    if verdict == 'recalibrate' and _is_contradicted(force, whole):
        verdict = 'unexplained'
    stds = standard_deviations(recordings, best)
    location = _locate(verdict, names.effects, base, whole[0])
    improvement = improvement_interval(parts, generator)
    progress('dependence of the residuals')
    by_name = dict(zip(MODELS, models))
    return Diagnosis(
        verdict=verdict, effects=names.effects, location=location,
        remainder=_remainder(decision.shares, best, whole[0]), nominal=models[0],
        recalibrated=models[1], corrected=models[2],
        stiffness=Value(best.model.stiffness, stds[0], 'N/m'),
        damping=Value(best.model.damping, stds[1], 'N s/m'),
        noise_floor=float(np.mean([one.force_noise for one in recordings])),
        force=force, motion=motion, improvement=improvement, holdouts=by_part(parts),
        next_experiment=advice(
            names.effects, names.rivals, verdict, models[0].nominal.environment.unilateral,
            _may_rub(recordings, best.model)),
        rivals=names.rivals,
        evidence=selection.evidence, residual_power=best.cost / best.residual_count,
        predictable=decision.predictable,
        dependences={name: dependences(whole[0], by_name[name], generator)
                     for name in pair_of(bool(names.effects))},
        recordings=recordings, free_runs=free_runs,
    )


class _Tested(NamedTuple):
    """A decision, its models refined, and their errors on the held-out parts."""

    decision: Decision
    recordings: Recordings
    base: Fit
    best: Fit
    parts: list[Part]
    free_runs: dict[str, Array]
    worse: bool


def _decided(fitted: Fitted, whole: Recordings, progress: Progress) -> _Tested:
    """Decide on names that the held-out parts do not contradict."""
    decision = decide(fitted.selection, whole, progress)
    tested = _tested(fitted, whole, decision, progress)
    if not tested.worse:
        return tested
    for other in alternatives(fitted.selection, decision, whole, progress):
        again = _tested(fitted, whole, other, progress)
        if again.best.model.effects and not again.worse:
            return again
    selection = decision.selection  # a false name is worse than no name
    unnamed = decide(selection._replace(best=selection.base), whole, progress)
    return _tested(fitted, whole, unnamed, progress)


def _named(tested: _Tested, whole: Recordings, generator: np.random.Generator) -> Names:
    """Name the effects of a decision."""
    recordings, best, decision = tested.recordings, tested.best, tested.decision
    return name_effects(
        best, standard_deviations(recordings, best), decision.selection, decision.shares,
        recordings, whole[0], generator)


def _tested(
    fitted: Fitted, whole: Recordings, decision: Decision, progress: Progress
) -> _Tested:
    """Test the models of a decision on held-out parts."""
    recordings, base, best = _refined(fitted.nominal, decision, progress)
    best = _nominal_where_unknown(fitted.nominal, recordings, best)
    progress('held-out parts')
    models = (fitted.nominal, base.model, best.model)
    parts, free_runs = _held_out(recordings, whole, fitted.holdouts, models)
    explained = 0.0 if decision.shares is None else decision.shares.explained
    worse = bool(best.model.effects) and (
        _worse(parts, best.model, not has_discrepancy(recordings),
               all(_drifts(one, best.model) for one in recordings))
        or _promises_more(explained, parts, max(one.force_noise for one in recordings)))
    return _Tested(decision, recordings, base, best, parts, free_runs, worse)


def _refined(
    nominal: Model, decision: Decision, progress: Progress
) -> tuple[Recordings, Fit, Fit]:
    """Minimise the output error of an explained recording; return base and best model."""
    selection, best = decision.selection, decision.best
    recordings, base = selection.recordings, selection.base
    if decision.unexplained or has_discrepancy(recordings) or not all(
            one.observed.has_dynamics(nominal.nominal) for one in recordings):
        return recordings, base, best
    progress('output error')
    if best.model.effects:
        recordings, best = refine_and_prune(recordings, best)
        return recordings, base, best
    recordings, base = refine(recordings, base)
    return recordings, base, base


def _is_contradicted(force: Errors, whole: Recordings) -> bool:
    """Return whether other values, that the motion asks for, are far worse for the force."""
    if force.nominal is None or force.recalibrated is None:
        return False
    least = max(least_material(one) for one in whole)
    return force.recalibrated > max(_MUCH_WORSE * force.nominal, least)


def _nominal_where_unknown(nominal: Model, recordings: Recordings, best: Fit) -> Fit:
    """Keep a nominal K_e or B_e that the data do not tell, such as the damping in a hold."""
    if not best.model.effects:
        return best
    stds = standard_deviations(recordings, best)
    for k in range(2):
        values = list(best.model.values)
        values[k] = nominal.values[k]
        if best.model.free[k] and stds[k] > abs(values[k]) > 0.0:
            kept = fit_at(recordings, best.model.at(values))
            best = kept if kept.cost < best.cost + _UNTOLD else best
    return best


def _drifts(recording: PreparedRecording, model: Model) -> bool:
    """Return whether a force drives a mass that no spring holds: its free run integrates twice."""
    o = recording.observed
    held = model.stiffness * float(np.std(o.x)) > _HELD * float(np.std(o.force))
    return o.driven_by_force(model.nominal) and not held


def _worse(parts: Sequence[Part], best: Model, exact: bool, drifts: bool = False) -> bool:
    """
    Return whether the corrected model predicts held-out data worse than the recalibrated one.

    Force and motion both, or one by far more than the other is better, or clearly the force alone
    if no name is of the robot. Names down to the noise may not show there at all, such as an
    adhesion without a separation. Of a motion that drifts the force alone counts.
    """
    force, motion = (
        one.corrected / one.recalibrated if one.recalibrated and one.corrected is not None
        else None for one in errors_of(parts))
    counted = (force,) if drifts else (force, motion)
    ratios = [ratio for ratio in counted if ratio is not None]
    if not ratios:
        return False
    of_robot = any(EFFECTS[name].port == 'robot' for name in best.effects)
    if exact and max(ratios) <= _THE_SAME:
        return False
    if min(ratios) >= 1.0 or prod(ratios) >= 1.0 and max(ratios) > _FAR_WORSE:
        return True
    return not of_robot and force is not None and force > _CLEARLY_WORSE


def _promises_more(explained: float, parts: Sequence[Part], noise: float) -> bool:
    """
    Return whether held-out data show little of what names are said to explain.

    The share of a misfit is that beyond what is uncertain of it. Values of a wall that make
    everything uncertain, such as a mass a hundred times that of the drive, explain nothing.
    """
    force, motion = errors_of(parts)
    if explained < _PROMISED or force.corrected is None or force.recalibrated is None or (
            force.recalibrated < _ABOVE_NOISE * noise):
        return False
    shown = [explained_share(force.recalibrated**2, force.corrected**2, noise**2)]
    if motion.corrected is not None and motion.recalibrated:
        shown.append(explained_share(motion.recalibrated**2, motion.corrected**2, 0.0))
    return max(shown) < _SHOWN


def _may_rub(recordings: Recordings, best: Model) -> bool:
    """Return whether a damping that makes up much of the force may be dry friction."""
    if best.nominal.environment.unilateral or has_paces(recordings):
        return False
    return any(best.damping * float(np.std(one.observed.v)) > _DAMPED * float(
        np.std(one.observed.force)) for one in recordings)


def _locate(
    verdict: str, names: Sequence[NamedEffect], base: Fit, shown: PreparedRecording
) -> Location | None:
    """Locate what the recalibrated model lacks."""
    if verdict not in ('physics_missing', 'unexplained'):
        return None
    return locate(shown, base.model, EFFECTS[names[0].name] if names else None)


def _remainder(shares: Shares | None, best: Fit, shown: PreparedRecording) -> Remainder | None:
    """Describe what all names leave on parts left out; None if that is noise."""
    if shares is None or shares.left < _NOTHING:
        return None
    # A mark tells a name that predicts nothing: on parts left out it may do harm.
    location, left = locate(shown, best.model), min(shares.left, 1.0)
    return Remainder(left, location, _text(left, location))


def _text(share: float, location: Location) -> str:
    """Say how much is left and where."""
    where = f' at {location.region}' if location.region else ''
    return (f'{100.0 * share:.0f} % of the misfit is left by all named effects together, mostly '
            f'in the {location.phase} phase{where}, {location.band_hz[0]:.2g} to '
            f'{location.band_hz[1]:.2g} Hz')


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
    """Return the free-run positions of the models; None where they tell nothing."""
    o = recording.observed
    if not o.has_dynamics(models[0].nominal):
        return None
    runs = [free_run(one, o).position for one in models[:2]]
    runs.append(runs[1] if models[2] is models[1] else free_run(models[2], o).position)
    away = max(float(np.max(np.abs(x - o.x))) for x in runs)
    if _drifts(recording, models[2]) and not away < float(np.ptp(o.x)):
        return None
    return runs
