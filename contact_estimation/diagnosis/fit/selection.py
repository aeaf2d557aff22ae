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

from .criteria import enough, explained_share, leaves_noise, PRICE, THRESHOLD
from .discrepancy import (
    costs_by_channel,
    has_discrepancy,
    material,
    noise_by_channel,
    weighed,
)
from .exact_laws import exact_laws, exact_pair, exchange, laws_before_curves, prune, Rivals
from .fitting import Fit, fit
from .flexible import predictable_share
from .marks import law_by_mark, Mark
from .order import ZEROS
from .ranking import rank_by_prediction, Ranking
from .revision import as_shown, narrowest, without_trifles
from .search import is_curve, Progress, search
from .simplest import FLEXIBLE_LEAD
from .zeros import beside, zeros_lacking
from ..observe.model import Model
from ..observe.prepared_recording import Recordings
from ...physics import EFFECTS

MOST_EFFECTS = 3
"""Effects that are selected at most."""

_FULLY = 0.995  # share of the misfit from which on the rest is the method's own error
_PREDICTABLE = 0.2  # share of the residuals from which on they are no noise
_SHARPER = 0.5  # cost beside the zeros, in that of a law alone, from which on these are needed
_NEARLY = 3.0  # mean square, in that of the noise, of what is small


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
    in_form : str
        The effect that holds in form alone, its size differing from part to part; '' if none.
    pair : tuple of str
        Two effects that predict only together; () if none.
    marked : str
        The effect that a mark in the force tells, however little it explains; '' if none.
    mark : Mark or None
        That mark.

    """

    recordings: Recordings
    base: Fit
    best: Fit
    rivals: Rivals
    evidence: dict[str, float]
    in_form: str = ''
    pair: tuple[str, ...] = ()
    marked: str = ''
    mark: Mark | None = None


def select(
    recordings: Recordings, base: Fit, progress: Progress = lambda name: None, *,
    by_likelihood: bool = True,
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
    by_likelihood : bool
        Whether laws down to the noise are told by their likelihood; else all are by prediction.

    Returns
    -------
    selection : Selection
        The effects taken, and their rivals.

    """
    best, evidence, rivals = base, dict[str, float](), Rivals()
    in_form, mark, marked, pair = '', None, '', tuple[str, ...]()
    while _law_count(best.model) < MOST_EFFECTS and not is_explained(recordings, base, best):
        carried, present = _carried(recordings, best)
        found = search(carried, present, progress)
        evidence = evidence or _evidence(carried, present, found)
        exact = _exact(recordings, carried, best, found, progress) if by_likelihood else []
        ranking = Ranking([])
        if not exact and not leaves_noise(best):
            progress('parts left out')
            ranking = _of_parts(recordings, carried, present, found, progress)
            if by_likelihood and not ranking.found:
                exact = exact_pair(recordings, best, found, progress)
        if exact and enough(best, exact[0]):
            best = narrowest(recordings, base, exact[0], progress)
            name = best.model.effects[-1]
            rivals[name] = [one for one in exact if one.model.effects[-1] != name]
            if len(best.model.effects) > 1:
                best, rivals = exchange(recordings, best, rivals, progress)
        elif ranking.found:
            best = fit(recordings, ranking.found[0].model)
            name, mark, pair = best.model.effects[-1], ranking.mark, pair or ranking.pair
            rivals[name] = ranking.found[1:]
            if ranking.in_form or mark:  # what is left would get a false name
                in_form, marked = name if ranking.in_form else '', name if mark else ''
                break
        else:
            break
    if leaves_noise(best):
        best, rivals = prune(recordings, best, rivals)
    best = narrowest(recordings, base, best, progress)
    if leaves_noise(best):
        best = fit(recordings, best.model) if best.model.effects else base
        return Selection(recordings, base, as_shown(recordings, best, progress), rivals, evidence)
    carried, best = weigh(recordings, best)
    best = as_shown(carried, without_trifles(carried, best), progress)
    in_form, marked, *now = (_now(name, best.model) for name in (in_form, marked, *pair))
    pair = tuple(now) if all(now) else ()
    return Selection(carried, fit(carried, base.model), best, rivals, evidence, in_form, pair,
                     marked, mark)


def _now(name: str, model: Model) -> str:
    """Return the effect of a model that stands for another of its family; '' if none does."""
    if not name or name in model.effects:
        return name
    alike = (one for one in model.effects if EFFECTS[one].family == EFFECTS[name].family)
    return next(alike, '')


def _law_count(model: Model) -> int:
    """Count the effects but for the zeros that every rig has."""
    return len(set(model.effects) - set(ZEROS))


def is_explained(recordings: Recordings, base: Fit, best: Fit) -> bool:
    """
    Return whether what is left is noise, or no more than the error of the method.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    base, best : Fit
        Recalibrated, and with effects.

    Returns
    -------
    explained : bool
        If so, no further effect is sought.

    """
    count = best.residual_count
    if best.cost < count * (1.0 + 0.5 * THRESHOLD):
        # The noise of the other channel may be estimated too large, and hide the excess of one.
        excess = costs_by_channel(recordings, best) - noise_by_channel(recordings, best.model)
        return bool(np.max(excess) < THRESHOLD * count + PRICE)
    if not best.model.effects or explained_share(base.cost, best.cost, count) <= _FULLY:
        return False
    # A wall that a force drives is measured more precisely than any law is valid.
    return leaves_noise(best) or all(one.driven_by_force(base.model) for one in recordings)


def _carried(recordings: Recordings, best: Fit) -> tuple[Recordings, Fit]:
    """Carry a discrepancy, unless only trifles are left: a law that is inexact explains none."""
    carried, present = weigh(recordings, best)
    if not material(carried, best.model) and best.cost < _NEARLY * best.residual_count:
        return recordings, present
    return carried, present


def _evidence(recordings: Recordings, present: Fit, found: Sequence[Fit]) -> dict[str, float]:
    """Return the share of the misfit that each candidate takes away."""
    misfit = max(present.cost - float(noise_by_channel(recordings, present.model).sum()),
                 1e-9 * present.cost)
    return {one.model.effects[-1]: (present.cost - one.cost) / misfit for one in found}


def _exact(
    recordings: Recordings, carried: Recordings, best: Fit, found: Sequence[Fit],
    progress: Progress,
) -> list[Fit]:
    """Return the candidates that leave no more than noise, beside the zeros if need be."""
    exact = (laws_before_curves(recordings, best.cost, found) if leaves_noise(best)
             else exact_laws(recordings, best.cost, found, carried is recordings))
    return _beside_zeros(recordings, best, exact, progress)


def _of_parts(
    recordings: Recordings, carried: Recordings, present: Fit, found: Sequence[Fit],
    progress: Progress,
) -> Ranking:
    """Rank candidates by prediction; a law beside the zeros goes before a curve."""
    ranking = _ranked(carried, present, found)
    if not ranking.found or not is_curve(recordings, ranking.found[0]):
        return ranking
    return ranking._replace(found=_law_instead(carried, present, ranking.found, progress))


def _ranked(
    recordings: Recordings, present: Fit, found: Sequence[Fit]
) -> Ranking:
    """Rank the candidates of other families by prediction, else tell one by its mark."""
    ranking = Ranking([])
    if has_discrepancy(recordings):
        families = {EFFECTS[name].family for name in present.model.effects}
        others = [one for one in found if EFFECTS[one.model.effects[-1]].family not in families]
        ranking = rank_by_prediction(recordings, present, others)
    if ranking.found:
        return ranking
    told = law_by_mark(recordings, present, found)
    return ranking if told is None else Ranking([told[0]], mark=told[1])


def _beside_zeros(
    recordings: Recordings, present: Fit, exact: list[Fit], progress: Progress
) -> list[Fit]:
    """
    Prefer laws beside the zeros to laws that leave what is predictable.

    The noise may be estimated too large, and hide what a law leaves: nothing is then below it.
    """
    lacking = zeros_lacking(present.model)
    if not exact or not lacking or all(
            predictable_share(one, exact[0].model) < _PREDICTABLE for one in recordings):
        return exact
    level = fit(recordings, beside(present.model, lacking))
    found = search(recordings, level, progress)
    laws = exact_laws(recordings, level.cost, found, True)
    return laws if laws and laws[0].cost < _SHARPER * exact[0].cost else exact


def _law_instead(
    recordings: Recordings, present: Fit, ranked: list[Fit], progress: Progress
) -> list[Fit]:
    """Rank laws beside the zeros that the model lacks; one that fits nearly as well goes first."""
    lacking = zeros_lacking(present.model)
    if not lacking:
        return ranked
    level = fit(recordings, beside(present.model, lacking))
    found = search(recordings, level, progress)
    laws = _ranked(recordings, level, found).found
    most = ranked[0].cost + FLEXIBLE_LEAD * (present.cost - ranked[0].cost)
    if laws and laws[0].cost <= most and not is_curve(recordings, laws[0]):
        return laws
    return ranked


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
    # The last selection weighs what it began with, if it takes nothing.
    return recordings[0].fits.of(
        (weigh, *recordings[1:], found.model), lambda: _refitted(recordings, found))


def _refitted(recordings: Recordings, found: Fit) -> tuple[Recordings, Fit]:
    for _ in range(2):  # the first fit is dominated by the channel with the least noise
        recordings = weighed(recordings, found.model)
        found = fit(recordings, found.model)
    return recordings, found
