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

"""Laws that are exact, down to the noise: the likelihood tells them sharply from their rivals."""

from __future__ import annotations

from typing import Sequence

from .criteria import ADEQUATE, enough, LEFT, noise_scale, penalty
from .first_step import fit_without
from .fitting import cost_of, Fit, fit, fit_to_end
from .order import best as best_of, prior, ranked, ranked_by
from .search import is_credible, is_curve, Progress, search
from .simplest import FLEXIBLE_LEAD
from ..observe.prepared_recording import Recordings

_EXCHANGE_GAIN = 10.0  # cost, in that of the noise
_ASSESSED = 12  # candidates that may be exact
_STRICTLY = 1.15  # mean square, in that of the noise, of a law that leaves nothing else
_NEAR_NOISE = 4.0  # the same, from which a candidate may be exact
_FIRST = 3  # candidates of which one may be the first of two
_NEARLY_EXACT, _POLISHED = 0.1, 5  # of the present cost, likewise; candidates fitted to the noise

BEYOND_DOUBT = 50.0
"""Cost by which one exact law is surely right instead of another: seven standard deviations."""

Rivals = dict[str, list[Fit]]
"""For each effect taken, fits with another in its place, best first."""


def exact_laws(
    recordings: Recordings, present: float, found: Sequence[Fit], strictly: bool
) -> list[Fit]:
    """
    Fit the candidates near the noise to it.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Without a discrepancy.
    present : float
        Cost without a candidate.
    found : sequence of Fit
        Candidates, best first.
    strictly : bool
        Whether one must leave the noise alone, not nearly.

    Returns
    -------
    fits : list of Fit
        Best first; none if none leaves so little.

    """
    count = sum(one.residual_count for one in recordings)
    largest = max(_NEAR_NOISE * count, _NEARLY_EXACT * present)
    nearest = _nearest(recordings, found)[:_POLISHED]
    near = [one for cost, one in nearest if cost < largest] or [one for _, one in nearest[:1]]
    fits = [fit_to_end(recordings, fit(recordings, one.model)) for one in near]
    fits = [one for one in fits if is_credible(recordings, one.model)]
    most = _STRICTLY if strictly else 1.0 + LEFT
    if not any(one.cost <= most * one.residual_count for one in fits):
        return []
    return simplest_first(laws_before_curves(recordings, present, fits), present)


def exact_pair(
    recordings: Recordings, present: Fit, found: Sequence[Fit], progress: Progress
) -> list[Fit]:
    """
    Fit the candidates to the noise beside one that takes away most of the misfit.

    Of two laws that are exact neither is exact alone.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Without a discrepancy.
    present : Fit
        To them, without candidates.
    found : sequence of Fit
        Candidates, of which none predicts enough.
    progress : callable
        Called with the name of each further candidate.

    Returns
    -------
    fits : list of Fit
        With two more effects, as of `exact_laws`.

    """
    nearest = _nearest(recordings, found)[:_FIRST]
    count, most = present.residual_count, 0.5 * (present.cost + present.residual_count)
    if not nearest or nearest[0][0] > most or present.cost < _NEAR_NOISE * count:
        return []
    fits = [fit_to_end(recordings, fit(recordings, one.model)) for _, one in nearest]
    laws = [one for one in fits
            if not is_curve(recordings, one)]
    best = best_of(laws, lambda one: one.cost + penalty(one.model))
    if best is None or best.cost > most:
        return []
    beside = search(recordings, best, progress)
    exact = exact_laws(recordings, best.cost, beside, False)
    if exact or not beside or beside[0].cost > _NEARLY_EXACT * present.cost:
        return exact
    # The first was bent towards what the second explains: search it anew beside that.
    second = fit_without(recordings, beside[0].model, best.model.effects[-1:])
    return exact_laws(recordings, second.cost, search(recordings, second, progress), False)


def _nearest(recordings: Recordings, found: Sequence[Fit]) -> list[tuple[float, Fit]]:
    """Return the best candidates by their cost without a discrepancy, and that cost."""
    costs = [(cost_of(recordings, one.model), one) for one in found[:_ASSESSED]]
    return ranked_by(costs, lambda pair: pair[0], lambda pair: prior(pair[1].name))


def simplest_first(fits: Sequence[Fit], present: float) -> list[Fit]:
    """
    Put the simplest of the laws that fit about as well as the best before it.

    Parameters
    ----------
    fits : sequence of Fit
        Of laws near the noise, best first.
    present : float
        Cost without them.

    Returns
    -------
    fits : list of Fit
        Where the best leaves only noise, those that leave no more than that, whose size is not
        known exactly, and are not worse beyond doubt are as good; else those that leave little
        more.

    """
    best, count = fits[0].cost, fits[0].residual_count
    if best <= _STRICTLY * count:
        most = min(float(count), best + BEYOND_DOUBT)
    else:
        most = best + ADEQUATE * (present - best)
    return sorted(fits, key=lambda one: (
        (0.0, penalty(one.model)) if one.cost <= most else (1.0, 0.0)))


def laws_before_curves(
    recordings: Recordings, present: float, fits: Sequence[Fit]
) -> list[Fit]:
    """
    Sort fits by penalised cost; curves that fit almost any misfit must lead by more.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    present : float
        Cost without them.
    fits : sequence of Fit
        With one more effect.

    Returns
    -------
    fits : list of Fit
        Best first.

    """
    scale = noise_scale(min(fits, key=lambda one: one.cost)) if fits else 1.0

    def charged(one: Fit) -> float:
        lead = FLEXIBLE_LEAD * max(present - one.cost, 0.0)
        return (one.cost + scale * penalty(one.model)
                + lead * is_curve(recordings, one))

    return ranked(fits, charged)


def exchange(
    recordings: Recordings, best: Fit, rivals: Rivals, progress: Progress
) -> tuple[Fit, Rivals]:
    """
    Revise early choices: replace each effect by any other beside the rest.

    Parameters
    ----------
    recordings, best, rivals, progress
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
        rest = fit_without(recordings, best.model, (name,))
        fits = search(recordings, rest, progress)
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
        shorter = [fit_without(recordings, best.model, (name,)) for name in best.model.effects]
        least = min(shorter, key=lambda found: found.cost)
        if enough(least, best):
            break
        best = least
    return best, {name: rivals.get(name, []) for name in best.model.effects}
