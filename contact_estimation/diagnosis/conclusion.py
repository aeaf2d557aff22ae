# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""From compared models to the result: names, values, held-out errors, verdict."""

from dataclasses import replace
from math import hypot
from typing import NamedTuple, Sequence

import numpy as np

from .dependence import dependences
from .fit.candidates import untried
from .fit.discrepancy import least_material, material, standard_deviations
from .fit.evidence import explained, misfits, ranked_by, Scored, share_of, ZEROS
from .fit.fitting import cost_of, Fit, fit
from .fit.free_run import fit_driven_wall, free_run
from .fit.left_out import predict
from .fit.names import name, Named, parts, without_least
from .held_out import (
    by_part, errors_of, HeldOutPart, improvement_interval, measure_part, spared_of,
    weigh_by_held_out, with_holdouts)
from .location import locate, Location
from .next_experiment import advice, nearly, perhaps
from .observe.model import Model
from .observe.prepared_recording import PreparedRecording, Recordings
from .observe.residuals import force_residual
from .observe.shares import MOST, SLIGHT
from .result import Diagnosis, EffectOnPart, NamedEffect, pair_of, Remainder, Value
from .views import Progress, Seen
from ..parameters import own_specifications
from ..physics import EFFECTS
from ..physics.numeric import Array

_SHOWS = 0.6  # of the error on what is fitted: less on the held-out part tells nothing of a name
_AS_FITTED = 1.5, 3.0  # times that error of force and free run, which drifts: more is no noise

MODELS = ('nominal', 'recalibrated', 'corrected')


def conclude(seen: Seen, seed: int, progress: Progress) -> Diagnosis:
    """Name what is missing, and test the models on held-out data."""
    progress('names')
    seen = with_holdouts(seen)
    named = name(seen.compared, seed, seen.without)
    tested = _tested(seen, named.model, progress)
    if named.names and not _holds(seen, named, tested):
        # Held-out data refute the likeliest model, and choose among all.
        seen = weigh_by_held_out(seen)
        named = name(seen.compared, seed, seen.without)
        tested = _tested(seen, named.model, progress)
    while named.names and not _holds(seen, named, tested):
        named = without_least(seen.compared, named, seen.without)
        tested = _tested(seen, named.model, progress)
    return _Conclusion(seen, named, tested, seed).diagnosis()


class _Tested(NamedTuple):
    """Models with their final values, and their errors on the held-out parts."""

    recordings: Recordings
    base: Fit
    best: Fit
    parts: list[HeldOutPart]
    free_runs: dict[str, Array]
    force_error: float  # of the recalibrated model, on what is fitted [N]
    free_run_error: float  # the same [m]


def _tested(seen: Seen, chosen: Scored, progress: Progress) -> _Tested:
    """Refine the values of a model, and measure its errors on held-out parts."""
    recordings, best = _fitted(seen, chosen)
    nominal = seen.view.given.nominal
    base = seen.base if chosen.named else best
    models = (nominal, base.model, best.model)
    progress('held-out parts')
    runs, parts = [_free_runs(one, models) for one in recordings], list[HeldOutPart]()
    known = {id(one.observed): each for one, each in zip(recordings, runs)}
    for spared in spared_of(seen.holdouts, recordings, base.model):
        o = spared.recording.observed
        positions = known[id(o)] if id(o) in known else _free_runs(spared.recording, models)
        parts.append(measure_part(spared, models, positions))
    left = np.concatenate([force_residual(one, base.model)[one.force.use] for one in recordings])
    errors = [(one.observed.raw_position - each[1])[one.use & ~one.observed.start]
              for one, each in zip(recordings, runs) if each is not None]
    usual = float(np.sqrt(np.mean(np.concatenate(errors) ** 2))) if errors else 0.0
    return _Tested(recordings, base, best, parts, dict(zip(MODELS, runs[0] or ())),
                   float(np.sqrt(np.mean(left**2))), usual)


def _holds(seen: Seen, named: Named, tested: _Tested) -> bool:
    """
    Return whether names hold: the one test of adequacy, by what is left out and held out.

    They explain a fair share of both in the channels that tell them: the force does not tell an
    effect of the robot, nor the motion one of the sensor. In none of them do they double the
    misfit.
    """
    evidence = seen.compared.evidence
    ports = {EFFECTS[one.effect].port for one in named.names}
    if named.model.found.found.model.laws().robot.joint is not None:
        ports.add('contact')  # what touches the wall moves otherwise than what is measured
    force, motion = errors_of(tested.parts)
    runs = list[float | None]()
    if ports != {'robot'}:
        noise = max(hypot(one.force_noise, least_material(one)) for one in seen.recordings)
        runs.append(force.explained(noise, _SHOWS * tested.force_error))
    channel = 1 if ports == {'robot'} else 0 if ports == {'force_sensor'} else None
    shares = [_share_of_held_out(seen, named.model, channel)]
    if ports != {'force_sensor'}:
        noise = max(one.observed.position_noise for one in seen.recordings)
        runs.append(motion.explained(noise, _SHOWS * tested.free_run_error))
        shares.append(runs[-1])
    left_out = explained(evidence, named.model, 1 if ports == {'robot'} else None).share
    if any(share is not None and share < -1.0 for share in runs):
        return False
    known = [share for share in shares if share is not None]
    return min(left_out, max(known, default=left_out)) >= evidence.constants.confirmed


def _share_of_held_out(seen: Seen, model: Scored, channel: int | None) -> float | None:
    """Return the share of the held-out misfit that a model explains; None if little is shown."""
    evidence, left_out = seen.compared.evidence, len(seen.models.parts)
    spared = () if seen.spared else spared_of(seen.holdouts, seen.recordings, seen.base.model)
    both = [predict(one, spared) for one in (evidence.base, model)]
    before, after = (misfits(evidence, one, channel) for one in both)
    columns = slice(None) if channel is None else slice(channel, channel + 1)
    noise = (both[0].counts * evidence.as_force)[:, columns]
    usual = float((noise * evidence.instrument[columns])[left_out:].sum())
    as_fitted = float(before[:left_out].sum() / noise[:left_out].sum())
    shown = float(before[left_out:].sum())
    if shown <= max(_SHOWS**2 * as_fitted * float(noise[left_out:].sum()), usual):
        return None
    return 1.0 - (float(after[left_out:].sum()) - usual) / (shown - usual)


def _fitted(seen: Seen, chosen: Scored) -> tuple[Recordings, Fit]:
    """Return the recordings and the fit of a model, without a discrepancy if it is exact."""
    if not seen.compared.evidence.is_exact(chosen):
        return chosen.found.recordings, chosen.found.found
    found = fit(seen.recordings, chosen.found.found.model)
    return fit_driven_wall(seen.recordings, found) if seen.driven else (seen.recordings, found)


def _free_runs(recording: PreparedRecording, models: Sequence[Model]) -> list[Array] | None:
    """Return the free-run positions of the models; None where they tell nothing."""
    o = recording.observed
    if not o.has_dynamics(models[0].nominal):
        return None
    runs = [free_run(one, o).position for one in models[:2]]
    runs.append(runs[1] if models[2] is models[1] else free_run(models[2], o).position)
    # Of a force that drives a mass the free run integrates twice.
    away = max(float(np.max(np.abs(x - o.x))) for x in runs)
    if o.driven_by_force(models[0].nominal) and not away < float(np.ptp(o.x)):
        return None
    return runs


class _Conclusion:
    """The parts of a result."""

    def __init__(self, seen: Seen, named: Named, tested: _Tested, seed: int) -> None:
        self._seen, self._named, self._tested = seen, named, tested
        self._seed, self._rng = seed, np.random.default_rng(seed)
        self._evidence = seen.compared.evidence
        self._recordings = ranked_by(  # the one with the largest misfit first
            tested.recordings, lambda one: -cost_of([one], tested.base.model) / max(
                one.residual_count, 1))
        self._shown = self._recordings[0]
        self._explained = explained(self._evidence, named.model)
        self._stds = standard_deviations(tested.recordings, tested.best)

    def diagnosis(self) -> Diagnosis:
        """Put the result together."""
        tested, seen = self._tested, self._seen
        effects = self._effects()
        base, best = tested.base, tested.best
        models = (seen.view.given.nominal, base.model, best.model)
        force, motion = errors_of(tested.parts)
        verdict = self._verdict(effects)
        by_name = dict(zip(MODELS, models))
        rivals = {key: one.found.found.model for key, one in self._named.rivals.items()}
        unilateral = models[0].nominal.environment.unilateral
        return Diagnosis(
            verdict=verdict, effects=effects, location=self._location(verdict, effects),
            remainder=self._remainder(effects), nominal=models[0], recalibrated=models[1],
            corrected=models[2], stiffness=Value(best.model.stiffness, self._stds[0], 'N/m'),
            damping=Value(best.model.damping, self._stds[1], 'N s/m'),
            noise_floor=float(np.mean([one.force_noise for one in self._recordings])),
            force=force, motion=motion,
            improvement=improvement_interval(tested.parts, self._rng),
            holdouts=by_part(tested.parts),
            next_experiment=advice(effects, rivals, verdict, unilateral), rivals=rivals,
            evidence={one.effects[0]: max(0.0, explained(self._evidence, one).share)
                      for one in seen.compared.models if len(one.effects) == 1},
            residual_power=best.cost / best.residual_count,
            dependences={key: dependences(self._shown, by_name[key], self._rng)
                         for key in pair_of(bool(effects))},
            recordings=self._recordings, free_runs=tested.free_runs,
            checks=seen.view.given.checks, holds_reference=seen.view.holds_reference,
            rests_left_out=seen.view.moving, held_out_chose=bool(seen.spared),
            untried=untried(tested.recordings, base.model),
            nearly=self._nearly(verdict),
            compared=seen.compared)

    def _nearly(self, verdict: str) -> str:
        """Say which law comes near where none explains, or may be missing beside the named."""
        models, named = self._seen.compared.models, self._named
        if verdict == 'unexplained' and not named.model.laws:
            return nearly(self._evidence, models)
        return perhaps(self._evidence, models, named.model, self._seed) if named.names else ''

    def _verdict(self, effects: Sequence[NamedEffect]) -> str:
        """Return the verdict, the one place where it is made."""
        if effects:
            return 'physics_missing' if self._explained.share >= MOST else 'unexplained'
        force, motion = errors_of(self._tested.parts)
        fitted = (max(self._tested.force_error, self._shown.force_noise),
                  max(self._tested.free_run_error, self._shown.observed.position_noise))
        for there, here, factor in zip(
                (force.recalibrated, motion.recalibrated), fitted, _AS_FITTED):
            if there is not None and there > factor * here:
                return 'unexplained'
        base = self._tested.base.model
        if not self._evidence.is_exact(self._evidence.base) and material(
                self._seen.models.weighed(base), base):
            return 'unexplained'
        nominal = self._seen.as_given()
        gain = self._evidence.score(self._evidence.base) - self._evidence.score(nominal)
        free = int(np.count_nonzero(base.free))
        price = self._evidence.constants.parameter * free
        return 'consistent' if gain < price else 'recalibrate'

    def _effects(self) -> list[NamedEffect]:
        """Describe the names: first what is expected to explain most."""
        model, names = self._named.model, {one.effect: one for one in self._named.names}
        if not names:
            return []
        values = self._tested.best.model
        told = parts(self._seen.compared, self._named, self._seen.without)
        zeros = [part for effect, part in told.items() if effect in ZEROS]
        rest = replace(self._evidence, base=zeros[-1].after) if zeros else None
        alone = [model.found.values_on(part) for part in model.found.parts]
        found = []
        for effect, (gain, share, _, before, _) in told.items():
            beside = None if rest is None or effect in ZEROS else share_of(rest, gain)
            cls, stds = EFFECTS[effect], self._stds[values.place(effect)]
            parameters = {
                spec.name: Value(value, float(std), spec.unit) for spec, value, std in zip(
                    own_specifications(cls), values.effect(effect).values().values(), stds)}
            on_parts = [
                EffectOnPart(part.name, float(of_part), each.effect(effect).values())
                for part, of_part, each in zip(model.found.parts, share.parts, alone)]
            found.append(NamedEffect(
                effect, cls.family, cls.port, cls.equation, names[effect].probability,
                share.share, share.interval, on_parts, parameters, names[effect].alike,
                locate(self._shown, before.found.found.model, cls), beside))
        return ranked_by(found, lambda one: -one.probability * one.share)

    def _location(self, verdict: str, effects: Sequence[NamedEffect]) -> Location | None:
        """Locate what the recalibrated model lacks."""
        if verdict not in ('physics_missing', 'unexplained'):
            return None
        model = self._tested.base.model
        if effects:
            return locate(self._shown, model, EFFECTS[effects[0].name])
        return locate(self._shown.whole(model), model)  # it may be in the held-out part alone

    def _remainder(self, effects: Sequence[NamedEffect]) -> Remainder | None:
        """Describe what all names leave on folds; None if that is noise."""
        left = min(1.0 - self._explained.share, 1.0)
        if not effects or left < SLIGHT:
            return None
        location = locate(self._shown, self._tested.best.model)
        where = f' at {location.region}' if location.region else ''
        low, high = location.band_hz
        return Remainder(left, location, (
            f'{100.0 * left:.0f} % of the misfit is left by all named effects together, mostly '
            f'in the {location.phase} phase{where}, {low:.2g} to {high:.2g} Hz'))
