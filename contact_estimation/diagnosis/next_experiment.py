# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The experiment that distinguishes effects which the recordings cannot.

Each candidate is simulated with the corrected model; then the rival is fitted to that motion and
to the old recordings together. Its remaining residuals are what the diagnosis would see
(T-optimality, Atkinson and Fedorov 1975, linearised).
"""

import dataclasses
from math import isfinite, sqrt
from typing import Collection, Mapping, NamedTuple, Sequence

import numpy as np

from .candidate_experiments import Candidate, candidates, Reach, scaling_test
from .checks.check import LISTED
from .fit.discrepancy import discounted
from .fit.evidence import Evidence, explained, of_families, ranked_by, Scored, ZEROS
from .fit.fitting import differentiate_by, residual_function
from .fit.free_run import plant_of, steps_a_sample
from .observe.model import Model
from .observe.observed import Observed
from .observe.parts import episodes
from .observe.prepared_recording import PreparedRecording, Recordings
from .observe.residuals import residuals
from .observe.shares import LITTLE, MOST, MUCH, SLIGHT
from .observe.usable_samples import default_block, usable
from .result import Diagnosis, NamedEffect
from ..physics.numeric import Array
from ..plant.simulation import simulate_on
from ..reference.experiment import Experiment

_LEAST_PACE = 0.1


class Proposal(NamedTuple):
    """The experiment to run next."""

    text: str  # in a sentence, with the expected difference
    experiment: Experiment  # to run


class Difference(NamedTuple):
    """Difference of two models in an experiment."""

    strength: float  # mean square of the residuals, in that of the noise
    force: float  # greatest difference of the forces, in standard deviations of one sample
    motion: float | None  # the same of the motion; None where no robot was recorded


def choose(diagnosis: Diagnosis) -> Proposal | None:
    """Propose an experiment."""
    if diagnosis.refused or not diagnosis.nominal.nominal.environment.unilateral:
        return None
    if diagnosis.rivals:
        return _separating(diagnosis)
    if diagnosis.verdict == 'unexplained':
        candidate = scaling_test(reach_of(diagnosis))
        words = f'{what_is_explained(diagnosis.effects)} {candidate.words}'
        return Proposal(words, candidate.experiment)
    return None


def reach_of(diagnosis: Diagnosis) -> Reach:
    """Measure the reach of the recordings, the limit of every proposal."""
    model = diagnosis.recalibrated
    depths, speeds, touching = [], [], []
    x_e = model.nominal.environment.location
    for recording in diagnosis.recordings:
        o = recording.observed
        depths.append(float(np.percentile(o.x[o.x > x_e], 98)) - x_e)
        speeds.append(float(np.max(np.abs(o.v))))
        touching += [abs(float(o.v[first])) for first, _ in episodes(model, o)]
    lowest = min(float(np.min(recording.observed.x)) for recording in diagnosis.recordings)
    robot = any(recording.observed.reference is not None for recording in diagnosis.recordings)
    gain = 1.0 + robot * model.stiffness / max(model.nominal.robot.stiffness, 1e-9)
    # Half of a touch-down speed of 0 would take infinitely long.
    typical = max(float(np.median(touching or speeds)), _LEAST_PACE * max(speeds))
    return Reach(x_e, x_e - lowest, max(depths), gain, max(speeds), typical)


def _separating(diagnosis: Diagnosis) -> Proposal:
    judge = Judge(diagnosis)
    judged = [(judge.least_difference(candidate.experiment), candidate)
              for candidate in candidates(reach_of(diagnosis))]
    difference, best = ranked_by(judged, lambda pair: -pair[0].strength)[0]
    pairs, noise = (indistinguishable_pairs(diagnosis.effects, diagnosis.rivals),
                    diagnosis.recordings[0].force_noise)
    return Proposal(_sentence(pairs, best, difference, len(judged), noise), best.repeated())


def _sentence(
    pairs: str, best: Candidate, difference: Difference, tried: int, force_noise: float
) -> str:
    size = (f'{_short(difference.force * force_noise)} N in force ({_short(difference.force)} '
            'times the noise of a sample)')
    if difference.motion is not None:
        size += f' and {_short(difference.motion)} times the noise in motion'
    if difference.strength < LITTLE:
        return (
            f'Within the reach of this recording it is hard to tell {pairs}. The best of {tried} '
            f'experiments is to {best.words}: whatever the values, the predictions then '
            f'differ by up to {size}. A deeper or faster contact would separate them better.')
    return (f'To tell {pairs}, {best.words}: whatever the values, their predictions then differ '
            f'by up to {size}.')


def _short(value: float) -> str:
    """Format with two digits, without an exponent."""
    return f'{value:.0f}' if value >= 10.0 else f'{value:.2g}'


class Judge:
    """Predicts by how much rivals would differ from the corrected model in an experiment."""

    def __init__(self, diagnosis: Diagnosis) -> None:
        self._model, self._rivals = diagnosis.corrected, dict(diagnosis.rivals)
        self._recording = diagnosis.recordings[0]
        self._gain = reach_of(diagnosis).gain
        self._known: Mapping[str, Array] = {
            name: _sensitivities(diagnosis.recordings, rival)
            for name, rival in self._rivals.items()
        }

    def least_difference(self, experiment: Experiment) -> Difference:
        """Simulate an experiment and compare."""
        played = discounted(self._played(experiment), self._model)
        true = residuals(played, self._model, robust=False)
        differences = (self._difference(played, true, name) for name in self._rivals)
        return min(differences, key=lambda difference: difference.strength)

    def _difference(self, played: PreparedRecording, true: Array, name: str) -> Difference:
        rival, known = self._rivals[name], self._known[name]
        off = residuals(played, rival, robust=False) - true
        new = _sensitivities([played], rival)
        target = np.concatenate((np.zeros(len(known)), -off))
        change = np.linalg.lstsq(np.concatenate((known, new)), target, rcond=1e-10)[0]
        parts = played.split(off + new @ change)
        strength = float(np.sum(parts**2)) / played.residual_count
        if not isfinite(strength):
            return Difference(0.0, 0.0, None)
        force, *motion = np.max(np.abs(parts), axis=1) / sqrt(played.block)
        return Difference(strength, float(force), float(motion[0]) if motion else None)

    def _played(self, experiment: Experiment) -> PreparedRecording:
        """Predict an experiment with the corrected model, without noise."""
        old = self._recording
        o, h = old.observed, old.observed.h
        t: Array = h * np.arange(round(experiment.duration / h), dtype=np.float64)
        setpoints = [experiment.desired(now) for now in t.tolist()]
        reference = np.array([(*desired[:3], 0.0) for desired in setpoints]).T
        if o.reference is None:
            x, v, a = _pressed(reference[:3], self._model, self._gain)
            force = self._model.laws().contact.force(t, x, v, a)
        else:
            rate = steps_a_sample(self._model, o) / h
            plant = dataclasses.replace(
                plant_of(self._model), sample_rate=1.0 / h, integration_rate=rate)
            _, x, v, a, _, force = np.array(
                simulate_on(plant, t, reference, float(reference[0, 0])), np.float64).T
        observed = Observed(
            t, h, force, np.ones(len(t), bool), x, x, v, a,
            None if o.reference is None else reference, o.position_noise, o.cutoff)
        return PreparedRecording(
            experiment.name, observed, old.force_noise, old.motion_noise,
            usable(self._model, observed), default_block(observed),
            observer=observed.observer_of(self._model.nominal),
            force_discrepancy=old.force_discrepancy, motion_discrepancy=old.motion_discrepancy)


def _pressed(motion: Array, model: Model, gain: float) -> Array:
    """Return the motion [SI], shape (3, N), of a robot that yields so much to the wall."""
    x_e = model.nominal.environment.location
    yields = np.where(motion[0] > x_e, 1.0 / gain, 1.0)
    return motion * yields + np.outer((1.0, 0.0, 0.0), x_e * (1.0 - yields))


def _sensitivities(recordings: Recordings, model: Model) -> Array:
    """Differentiate the residuals by the relative change of each free value."""
    function = residual_function(recordings, model, robust=False)
    values = model.coordinates
    return differentiate_by(values, model.steps, function, function(values), most=model.ranges[1])


def nearly(evidence: Evidence, models: Sequence[Scored]) -> str:
    """Say which law nearly explains what no name explains."""
    alone = [(explained(evidence, one), one) for one in models if one.laws == 1]
    share, model = max(alone, key=lambda pair: pair[0].share, default=(None, evidence.base))
    if share is None or share.share < MUCH:
        return ''
    effect = next(name for name, family in zip(model.effects, model.families)
                  if family and name not in ZEROS)
    low, high = share.interval
    why = (f'{len(share.parts)} parts cannot prove it (95 %: {100.0 * low:.0f} to '
           f'{100.0 * high:.0f} %)' if low < MOST else 'it does not explain the held-out part')
    return (f'{effect} would explain {100.0 * share.share:.0f} %, but {why}: record further '
            'contacts at other depths and speeds')


def perhaps(evidence: Evidence, models: Sequence[Scored], named: Scored, seed: int) -> str:
    """Say which law, beside those that are named, may be missing too."""
    with_more = [one for one in evidence.ranked(models)
                 if named.named < one.named and len(one.effects) == len(named.effects) + 1]
    likely = of_families(models, evidence.weights(models, seed))
    for one in with_more[:1]:
        family, = one.named - named.named
        before, after = (explained(evidence, model).share for model in (named, one))
        if likely[family] >= evidence.constants.listed and after - before > SLIGHT:
            effect = one.effects[one.families.index(family)]
            return (f'{effect} may be missing too (probability {likely[family]:.2f}): beside it '
                    f'{100.0 * after:.0f} instead of {100.0 * before:.0f} % would be explained')
    return ''


def advice(
    names: Sequence[NamedEffect], rivals: Collection[str], verdict: str, touching: bool
) -> str:
    """Recommend what to run next."""
    pairs = indistinguishable_pairs(names, rivals)
    if pairs:
        return f'To tell {pairs}, run an experiment in which their predictions differ most.'
    if verdict == 'unexplained':
        again = 'contact at half and at twice the speed and depth' if touching else (
            'motion at half and at twice the speed and amplitude')
        return (f'{what_is_explained(names)} Repeat the same {again}: how the residuals scale '
                'shows what is missing.')
    return ''


def diagnose_apart(springs: Array) -> str:
    """Recommend what to run where each contact fits a wall of its own."""
    listed = ', '.join(f'{spring:.4g}' for spring in springs[:LISTED])
    listed += ' ...' if len(springs) > LISTED else ''
    return (f'Each contact fits a spring and a damper of its own, with K_e = {listed} N/m. '
            'Diagnose contacts of one object at one place together, and each object or place by '
            'itself.')


def what_is_explained(names: Sequence[NamedEffect]) -> str:
    """Say how far the library explains a mismatch whose verdict is 'unexplained'."""
    if not names:
        return 'No effect of the library explains this.'
    verb = 'explains' if len(names) == 1 else 'explain'
    return f'{" and ".join(effect.name for effect in names)} {verb} only a part of this.'


def listed(names: Sequence[str]) -> str:
    """List names in words."""
    *others, last = names
    return f'{", ".join(others)} and {last}' if others else last


def indistinguishable_pairs(names: Sequence[NamedEffect], rivals: Collection[str]) -> str:
    """List which effects cannot be distinguished from which."""
    pairs = [(effect.name, [other for other in effect.indistinguishable_from if other in rivals])
             for effect in names]
    return '; '.join(f'{name} from {listed(others)}' for name, others in pairs if others)
