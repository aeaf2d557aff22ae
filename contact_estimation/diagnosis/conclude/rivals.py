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

"""What recordings cannot distinguish from a named effect."""

from __future__ import annotations

from typing import Sequence

from numpy.random import Generator

from .held_out import as_good
from ..fit.applicable import candidates_in, tells_time_from_path, told_by_a_return
from ..fit.criteria import enough, noise_scale, PRICE
from ..fit.discrepancy import has_discrepancy
from ..fit.first_step import fit_without
from ..fit.fitting import Fit, fit
from ..fit.model_uncertainty import discounted
from ..fit.order import ranked
from ..fit.search import search, search_family
from ..fit.selection import Selection
from ..fit.zeros import beside, zeros_lacking
from ..observe.prepared_recording import Recordings
from ...physics import EFFECTS

_NEAREST, _MOST_RIVALS = 4, 2
_LIKELIER = 8.0  # cost that a further parameter must take away: by BIC
_OF_ZEROS = 0.5  # least share of the misfit that a zero takes away alone, for rivals beside it
_OF_TIME, _OF_PATH = 'relaxation', ('friction', 'hysteresis')  # families of memories
_MOSTLY = 0.7  # of the gain of a memory: the other explains it, too
_NEAR = 3.0  # times the best cost: other rivals are out of the question


def indistinguishable(
    best: Fit, name: str, selection: Selection, recordings: Recordings, generator: Generator
) -> list[Fit]:
    """
    List what recordings cannot distinguish from an effect.

    Parameters
    ----------
    best : Fit
        The model with the effect.
    name : str
        Of the effect.
    selection : Selection
        With its rivals.
    recordings : sequence of PreparedRecording
        As fitted.
    generator : numpy.random.Generator
        Of the bootstraps.

    Returns
    -------
    alike : list of Fit
        With other effects in its place, best first.

    """
    rivals = _rivals(selection, name, recordings)
    if name == selection.marked:  # a mark tells the family alone
        alike = [rival for rival in rivals if not is_other(rival, EFFECTS[name].family)]
        alike = alike[:_MOST_RIVALS]
    else:
        alike = _predicting_alike(best, name, rivals, recordings, generator)
    known = [rival.model.effects[-1] for rival in alike]
    return alike + [other for other in _memories_alike(best, name, recordings)
                    if other.model.effects[-1] not in known]


def _rivals(selection: Selection, name: str, recordings: Recordings) -> list[Fit]:
    """Fit the nearest rivals, and its family if no law is exact, to the motion as smoothed now."""
    near = _NEAR * selection.best.cost
    nearest = [rival for rival in selection.rivals.get(name, [])[:_NEAREST] if rival.cost < near]
    fits = [fit(recordings, rival.model, steps=8) for rival in nearest]
    if has_discrepancy(recordings):
        known = {found.model.effects[-1] for found in fits}
        family = search_family(recordings, selection.best.model, name, _quietly)
        fits += [found for found in family if found.model.effects[-1] not in known]
        fits += beside_zeros(selection, name, recordings)
    fits += _until_a_return(selection, name, recordings)
    fits.sort(key=lambda found: found.cost, reverse=True)
    best_of = {found.model.effects[-1]: found for found in fits if found.model.plausible()}
    return ranked(best_of.values(), lambda found: found.cost)


def beside_zeros(selection: Selection, name: str, recordings: Recordings) -> list[Fit]:
    """
    Fit the laws that may stand in the place of an effect beside zeros that a model lacks.

    A memory forgets a zero; a law without one must not be worse for that.

    Parameters
    ----------
    selection : Selection
        With the model, and with what a zero explains alone.
    name : str
        Of the effect.
    recordings : sequence of PreparedRecording
        As fitted.

    Returns
    -------
    fits : list of Fit
        Best first; none unless a zero alone explains half of the misfit.

    """
    rest = selection.best.model.without(name)
    zeros = [zero for zero in zeros_lacking(rest)
             if zero != name and selection.evidence.get(zero, 0.0) >= _OF_ZEROS]
    if not zeros:
        return []
    level = fit(recordings, beside(rest, zeros))
    return search(recordings, level, _quietly)[:_NEAREST]


def _until_a_return(selection: Selection, name: str, recordings: Recordings) -> list[Fit]:
    """Fit the losses that look like an effect until the motion returns, best first."""
    rest = selection.best.model.without(name)
    losses = told_by_a_return(recordings, rest)
    if not losses:
        return []
    found = fit_without(recordings, selection.best.model, (name,))
    return search(recordings, found, _quietly, losses)[:_NEAREST]


def _quietly(name: str) -> None:
    """Report no progress."""


def _predicting_alike(
    best: Fit, name: str, rivals: Sequence[Fit], recordings: Recordings, generator: Generator
) -> list[Fit]:
    """
    Select the rivals that predict held-out data as well.

    Those of other families must fit as well too. Where no law is exact, that tells nothing of
    those of the same.
    """
    exact = not has_discrepancy(recordings)
    family = EFFECTS[name].family
    near = [rival for rival in rivals if name != rival.model.effects[-1] and (
        not enough(rival, best) and _is_as_likely(best, rival) if exact
        else not is_other(rival, family) or not enough(rival, best))]
    if not near:
        return []
    held = [(discounted(one.whole(best.model), best.model), one.held_out.samples)
            for one in recordings if one.held_out is not None]
    alike = [rival for rival in near if all(
        as_good(whole, samples, best.model, rival.model, generator) for whole, samples in held)]
    return alike[:_MOST_RIVALS]


def _memories_alike(best: Fit, name: str, recordings: Recordings) -> list[Fit]:
    """
    Fit the memory of the path in the place of one of time, or the other way round.

    At one speed nothing tells one from the other, even if a law of the one family happens to fit
    better than those of the other.
    """
    family = EFFECTS[name].family
    others = _OF_PATH if family == _OF_TIME else (_OF_TIME,) if family in _OF_PATH else ()
    if not others or tells_time_from_path(recordings):
        return []
    rest = fit_without(recordings, best.model, (name,))
    laws = [law for law in candidates_in(recordings, rest.model) if EFFECTS[law].family in others]
    gain = rest.cost - best.cost
    return [found for found in search(recordings, rest, _quietly, laws)
            if rest.cost - found.cost >= _MOSTLY * gain and found.model.plausible()][:1]


def _is_as_likely(best: Fit, rival: Fit) -> bool:
    """
    Return whether an exact law is as likely as the one that was taken.

    Of laws that fit alike, the one with fewer parameters is right. It was taken for its simplicity
    if a wider one fits better, but not beyond doubt.
    """
    further = len(rival.model.values) - len(best.model.values)
    scale = noise_scale(best)
    if further > 0:
        return rival.cost < best.cost - _LIKELIER * scale * further
    return rival.cost - best.cost <= PRICE * scale


def is_other(rival: Fit, family: str) -> bool:
    """
    Return whether the law of a rival is of another family.

    Parameters
    ----------
    rival : Fit
        With the law as its last effect.
    family : str
        Of the effect in whose place it is.

    Returns
    -------
    other : bool
        If so, an experiment may tell which.

    """
    return EFFECTS[rival.model.effects[-1]].family != family


def other_families(family: str, alike: Sequence[Fit]) -> set[str]:
    """
    Return the families that may be right instead: a probability is that of the family.

    Parameters
    ----------
    family : str
        Of the effect that is named.
    alike : sequence of Fit
        Its rivals.

    Returns
    -------
    families : set of str
        Without its own.

    """
    return {EFFECTS[rival.model.effects[-1]].family for rival in alike} - {family}
