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

"""
Selection of the effects that recordings support.

Where a law is exact, down to the noise, the likelihood tells it sharply from its rivals: forward
search, exchange and pruning. Real things obey no law to the noise of a good sensor. What the
present model leaves is then carried as a discrepancy, and the next effect is the one that best
predicts parts of the recordings that it was not fitted on; of effects that predict alike, the
simplest.
"""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .criteria import (
    enough,
    explained_share,
    leaves_noise,
    LEFT,
    noise_scale,
    penalty,
    predicts_enough,
    SHARE,
    THRESHOLD,
)
from .discrepancy import has_discrepancy, is_immaterial, with_discrepancy
from .fitting import cost_of, Fit, fit, fit_to_end
from .invariance import left_out_errors, Part, parts_of, share_of
from .model_uncertainty import discounted
from .search import candidates_for, is_pressed, Progress, search
from ..observe.model import Model, names_of
from ..observe.prepared_recording import Recordings
from ...physics import EFFECTS

Array = NDArray[np.float64]

MOST_EFFECTS = 3
"""Effects that are selected at most."""

_FULLY = 0.995  # share of the misfit from which on the rest is the method's own error
_EXCHANGE_GAIN = 10.0  # cost, in that of the noise
_ASSESSED = 8  # candidates that are fitted to the end and predict parts left out
_NEARLY, _STRICTLY = 3.0, 1.15  # mean squares, in that of the noise: small, and none
_NEAR_NOISE = 4.0  # mean square, in that of the noise, from which a candidate may be exact
_NEARLY_EXACT, _POLISHED = 0.1, 5  # of the present cost, likewise; candidates fitted to the noise
_PROMISING = 0.4  # of the largest gain in the fit, to be assessed
_ADEQUATE = 0.05  # of the gain: a simpler law may predict that much less
_GENERIC_SHARE, _GENERIC_LEAD = 0.85, 0.15  # what a curve that fits anything slow must show

Rivals = dict[str, list[Fit]]


class Selection(NamedTuple):
    """
    The result of a selection.

    Attributes
    ----------
    recordings : sequence of PreparedRecording
        With the discrepancy that the selected model leaves, if it leaves more than noise.
    base : Fit
        Recalibrated, without effects.
    best : Fit
        With the effects taken; `base` itself if none was.
    rivals : dict of str to list of Fit
        For each effect taken, fits with another in its place, best first.
    evidence : dict of str to float
        Share of the misfit above the noise that one effect alone takes away, by name.

    """

    recordings: Recordings
    base: Fit
    best: Fit
    rivals: Rivals
    evidence: dict[str, float]


def select(
    recordings: Recordings, base: Fit, progress: Progress = lambda name: None,
    with_robot: bool = True,
) -> Selection:
    """
    Select the effects that recordings ask for.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together, without a discrepancy.
    base : Fit
        Recalibrated model without effects.
    progress : callable
        Called with the name of each candidate.
    with_robot : bool
        Whether robot effects are candidates, if there is a robot.

    Returns
    -------
    selection : Selection
        The effects taken, and their rivals.

    """
    with_robot = with_robot and any(
        recording.observed.reference is not None for recording in recordings)
    best, evidence = base, dict[str, float]()
    driven = all(one.driven_by_force(base.model) for one in recordings)
    rivals: Rivals = {}
    for count in range(MOST_EFFECTS):
        if best.cost < best.residual_count * (1.0 + 0.5 * THRESHOLD):
            break  # the rest is noise
        explained = explained_share(base.cost, best.cost, best.residual_count)
        if count > 0 and driven and explained > _FULLY:
            break  # a wall that a force drives is measured more precisely than any law is valid
        weighed, present = weigh(recordings, best)
        if all(is_immaterial(one, base.model) for one in weighed) and _nearly_noise(best):
            weighed = recordings  # a law that is not exact says nothing here
        names = candidates_for(best.model, with_robot, is_pressed(recordings, best.model))
        found = search(weighed, present, names, progress)
        if count == 0:
            misfit = max(present.cost - _noise(weighed, present.model), 1e-9 * present.cost)
            evidence = {one.model.effects[-1]: (present.cost - one.cost) / misfit
                        for one in found}
        fits = found if leaves_noise(best) else _exact(
            recordings, best.cost, found, weighed is recordings)
        if leaves_noise(best) or fits:
            if not fits or not enough(best, fits[0]):
                break
            best = fits[0]
            rivals[best.model.effects[-1]] = fits[1:]
            if count > 0:
                best, rivals = exchange(recordings, best, rivals, with_robot, progress)
        elif not has_discrepancy(weighed):
            break
        else:
            progress('parts left out')
            families = {EFFECTS[name].family for name in best.model.effects}
            others = [one for one in found
                      if EFFECTS[one.model.effects[-1]].family not in families]
            ranked = _rank_by_prediction(weighed, present, base.model, others[:_ASSESSED])
            if not ranked:
                break
            best = fit(recordings, ranked[0].model)
            rivals[best.model.effects[-1]] = ranked[1:]
    if leaves_noise(best):
        best, rivals = prune(recordings, best, rivals)
        best = fit(recordings, best.model) if best.model.effects else base
        return Selection(recordings, base, best, rivals, evidence)
    weighed, best = weigh(recordings, best)
    best = _without_trifles(weighed, best)
    return Selection(weighed, fit(weighed, base.model), best, rivals, evidence)


def _without_trifles(recordings: Recordings, best: Fit) -> Fit:
    """Drop effects that later ones have made superfluous."""
    for name in best.model.effects[:-1]:
        rest = fit(recordings, best.model.without(name))
        misfit = rest.cost - _noise(recordings, best.model)
        if rest.cost - best.cost < SHARE * misfit:
            return _without_trifles(recordings, rest)
    return best


def weigh(recordings: Recordings, found: Fit) -> tuple[Recordings, Fit]:
    """
    Carry what a model leaves beyond noise as a discrepancy, and fit it again.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    found : Fit
        To them.

    Returns
    -------
    recordings : sequence of PreparedRecording
        The same if the model leaves noise only.
    refitted : Fit
        To them.

    """
    if leaves_noise(found):
        return recordings, found
    for _ in range(2):  # the first fit is dominated by the channel with the least noise
        recordings = [discounted(with_discrepancy(one, found.model), found.model)
                      for one in recordings]
        found = fit(recordings, found.model)
    return recordings, found


def _noise(recordings: Recordings, model: Model) -> float:
    """Return the cost that noise alone would leave."""
    return sum(float(channel.noise_share.sum()) for one in recordings
               for channel in one.channels(model))


def _nearly_noise(found: Fit) -> bool:
    return found.cost < _NEARLY * found.residual_count


def _exact(
    recordings: Recordings, present: float, found: Sequence[Fit], strictly: bool
) -> list[Fit]:
    """Fit the candidates near the noise to it; return them, best first, if one leaves no more."""
    count = sum(one.residual_count for one in recordings)
    largest = max(_NEAR_NOISE * count, _NEARLY_EXACT * present)
    costs = [(cost_of(recordings, one.model), k) for k, one in enumerate(found[:_ASSESSED])]
    ranked = sorted(costs)
    near = [found[k] for cost, k in ranked[:_POLISHED] if cost < largest or cost == ranked[0][0]]
    fits = [fit_to_end(recordings, fit(recordings, one.model)) for one in near]
    fits = [one for one in fits if one.model.plausible()]
    most = _STRICTLY if strictly else 1.0 + LEFT
    if not any(one.cost <= most * one.residual_count for one in fits):
        return []
    scale = noise_scale(min(fits, key=lambda one: one.cost))
    return sorted(fits, key=lambda one: one.cost + scale * penalty(one.model))


class _Candidate(NamedTuple):
    """A fitted candidate, and its errors on parts left out, shape (parts,)."""

    found: Fit
    errors: Array
    generic: bool

    @property
    def name(self) -> str:
        return self.found.model.effects[-1]

    @property
    def total(self) -> float:
        return float(self.errors.sum())

    @property
    def size(self) -> int:
        return len(names_of(self.name))


def _rank_by_prediction(
    recordings: Recordings, present: Fit, base: Model, found: Sequence[Fit]
) -> list[Fit]:
    """Rank candidates by their errors on parts left out; none if the best explains too little."""
    # No law predicts much better than it fits.
    gains = [present.cost - one.cost for one in found]
    noise = _noise(recordings, present.model)
    found = [one for one, gain in zip(found, gains)
             if gain > max(SHARE * (present.cost - noise), _PROMISING * max(gains))]
    if not found:
        return []
    first = fit(recordings, base) if present.model.effects else present
    parts = parts_of(recordings, first)
    before = left_out_errors(recordings, present, parts)
    whole = left_out_errors(recordings, first, parts) if present.model.effects else before
    duration = max(float(one.observed.t[-1]) for one in recordings)
    assessed = []
    for one in found:
        fitted = fit_to_end(recordings, one._replace(ended=False))
        if fitted.model.plausible():
            assessed.append(_Candidate(
                fitted, left_out_errors(recordings, fitted, parts, before),
                _is_generic(fitted.model, duration)))
    taken = _choose(assessed, before, parts)
    if taken is not None:
        taken = _simpler_beside_an_offset(recordings, assessed, taken, before, parts)
    if taken is None or not predicts_enough(
            share_of(before, taken.errors, parts, before),
            share_of(before, taken.errors, parts, whole), taken.generic):
        return []
    rest = sorted((one for one in assessed if one is not taken), key=lambda one: one.total)
    return [taken.found, *(one.found for one in rest)]


def _choose(
    assessed: Sequence[_Candidate], before: Array, parts: Sequence[Part]
) -> _Candidate | None:
    """Choose the candidate that predicts best, or the simplest of those that are adequate."""
    laws = [one for one in assessed if not one.generic]
    winner = min(laws, key=lambda one: one.total, default=None)
    curve = min((one for one in assessed if one.generic), key=lambda one: one.total, default=None)
    if curve is not None:
        share = share_of(before, curve.errors, parts, before)
        misfit = float(before.sum()) - sum(part.noise for part in parts)
        lead = (winner.total if winner else float(before.sum())) - curve.total
        if (share.share > _GENERIC_SHARE and share.parts.min() > 0.0
                and lead > _GENERIC_LEAD * misfit):
            return curve
    if winner is None:
        return None
    gain = float(before.sum()) - winner.total
    adequate = [one for one in laws if one.total <= winner.total + _ADEQUATE * gain]
    attached = not winner.found.model.nominal.environment.unilateral
    if attached and winner.name == 'contact_offset':  # of a spring: the same as a force
        winner = next((one for one in adequate if one.name == 'force_bias'), winner)
    simpler = [one for one in adequate if one.size < winner.size]
    return min(simpler, key=lambda one: (one.size, one.total), default=winner)


def _simpler_beside_an_offset(
    recordings: Recordings, assessed: Sequence[_Candidate], taken: _Candidate, before: Array,
    parts: Sequence[Part],
) -> _Candidate:
    """Return a simpler law if it predicts as well beside a bias, which comes next."""
    most = taken.total + _ADEQUATE * (float(before.sum()) - taken.total)
    if 'force_bias' in taken.found.model.effects:
        return taken
    for one in sorted(assessed, key=lambda one: one.total):
        if one.size + 1 < taken.size and not one.generic:
            model = one.found.model.with_effect('force_bias', (0.0,))
            beside = fit(recordings, model)
            if float(left_out_errors(recordings, beside, parts).sum()) <= most:
                return one
    return taken


def _is_generic(model: Model, duration: float) -> bool:
    """Return whether the last effect is a curve that follows any slow misfit."""
    name = model.effects[-1]
    values = EFFECTS[name].Parameters(*model.values[model.place(name)])
    return EFFECTS[name].follows_any_slow_misfit(values, duration)


def exchange(
    recordings: Recordings, best: Fit, rivals: Rivals, with_robot: bool,
    progress: Progress,
) -> tuple[Fit, Rivals]:
    """
    Revise early choices: replace each effect by any other beside the rest.

    Parameters
    ----------
    recordings, best, rivals, with_robot, progress
        As in `select`.

    Returns
    -------
    best : Fit
        No single exchange makes it better.
    rivals : dict
        For each effect, what could stand in its place.

    """
    rivals = dict(rivals)
    for name in best.model.effects[:-1]:
        rest = fit(recordings, best.model.without(name))
        names = candidates_for(rest.model, with_robot, is_pressed(recordings, rest.model))
        fits = search(recordings, rest, names, progress)
        # A wider law always fits a little better: it is charged for its parameters.
        least = _EXCHANGE_GAIN + (penalty(fits[0].model) - penalty(best.model) if fits else 0.0)
        if fits and fits[0].cost < best.cost - noise_scale(best) * least:
            best = fits[0]
            rivals.pop(name, None)
            rivals[best.model.effects[-1]] = fits[1:]
        else:
            rivals[name] = [found for found in fits if found.model.effects[-1] != name]
    return best, rivals


def prune(recordings: Recordings, best: Fit, rivals: Rivals) -> tuple[Fit, Rivals]:
    """
    Drop superfluous effects; parameters as `exchange`.

    Returns
    -------
    best : Fit
        Without any of its effects it would be significantly worse.
    rivals : dict
        Of the remaining effects.

    """
    while len(best.model.effects) > 1:
        shorter = [fit(recordings, best.model.without(name)) for name in best.model.effects]
        least = min(shorter, key=lambda found: found.cost)
        if enough(least, best):
            break
        best = least
    return best, {name: rivals.get(name, []) for name in best.model.effects}
