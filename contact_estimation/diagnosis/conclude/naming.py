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

"""The names of a diagnosis: probability, rivals, location."""

from __future__ import annotations

from typing import Collection, NamedTuple, Sequence

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from .held_out import as_good
from .location import locate
from .probability import probabilities, probability_in_form, probability_of
from .result import NamedEffect, Value
from .shares import Shares
from ..fit.criteria import enough, noise_scale, PRICE
from ..fit.discrepancy import has_discrepancy
from ..fit.fitting import Fit, fit
from ..fit.model_uncertainty import discounted
from ..fit.search import search, search_family
from ..fit.selection import Selection
from ..fit.zeros import beside, zeros_lacking
from ..observe.model import Model, names_of
from ..observe.prepared_recording import PreparedRecording, Recordings
from ...parameters.specification import specifications
from ...physics import EFFECTS

Array = NDArray[np.float64]

_NEAREST, _MOST_RIVALS = 4, 2
_LISTED = 8  # contacts
_LIKELIER = 8.0  # cost that a further parameter must take away: by BIC
_OF_ZEROS = 0.5  # least share of the misfit that a zero takes away alone, for rivals beside it
_NEAR = 3.0  # times the best cost: other rivals are out of the question


class Names(NamedTuple):
    """
    Name the effects of a model, with the effects they may be confused with.

    Attributes
    ----------
    effects : list of NamedEffect
        First the one whose omission costs most.
    rivals : dict of str to Model
        Fitted models with an indistinguishable effect in the place of a named one, by its name.

    """

    effects: list[NamedEffect]
    rivals: dict[str, Model]


def name_effects(
    best: Fit, stds: Array, selection: Selection, shares: Shares | None,
    recordings: Recordings, shown: PreparedRecording, generator: Generator,
) -> Names:
    """
    Name every effect of a model.

    Parameters
    ----------
    best : Fit
        The model.
    stds : ndarray, shape (P,)
        Standard deviations of all its values.
    selection : Selection
        With the rivals of the effects.
    shares : Shares or None
        What the effects predict on parts left out; None without effects.
    recordings : sequence of PreparedRecording
        As fitted.
    shown : PreparedRecording
        In which the effects are located.
    generator : numpy.random.Generator
        Of the bootstraps.

    Returns
    -------
    names : Names
        None for a model without effects.

    """
    if shares is None:
        return Names([], {})
    effects, rival_models = [], {}
    exact = not has_discrepancy(recordings)
    likely = dict(zip(best.model.effects, probabilities(
        [shares.of_channel[name] for name in best.model.effects],
        [shares.beside[name] for name in best.model.effects], shares.left, exact)))
    likely.update({name: probability_in_form(share) for name, share in shares.in_form.items()})
    told = selection.marked
    if selection.mark is not None and told in best.model.effects:
        likely[told] = probability_of(1.0 - selection.mark.spread)
    for name in sorted(best.model.effects, key=lambda name: -shares.of[name].share):
        dropped = fit(recordings, best.model.without(name), steps=8)
        rivals = _rivals(selection, name, recordings)
        cls, share = EFFECTS[name], shares.of[name]
        # A mark tells the family alone.
        alike = ([rival for rival in rivals if not _is_other(rival, cls.family)][:_MOST_RIVALS]
                 if name == told else _alike(best, name, rivals, recordings, generator))
        # Where no law is exact, no experiment tells those of a family: it would be like none.
        others = alike if exact else [rival for rival in alike if _is_other(rival, cls.family)]
        rival_models.update({rival.model.effects[-1]: rival.model for rival in others})
        effects.append(NamedEffect(
            name, cls.family, cls.port, cls.equation,
            likely[name] / (1.0 + exact * len(_other_families(cls.family, alike))),
            share.share, share.interval, shares.on_parts(name), _values(best, name, stds),
            [rival.model.effects[-1] for rival in alike],
            locate(shown, dropped.model, cls),
            shares.in_form[name].share if name in shares.in_form else None,
            selection.mark if name == told else None))
    return Names(effects, rival_models)


def _values(best: Fit, name: str, stds: Array) -> dict[str, Value]:
    place = best.model.place(name)
    units = [spec.unit for spec in specifications(EFFECTS[name].Parameters)]
    return {
        parameter: Value(value, float(std), unit) for parameter, value, std, unit in zip(
            names_of(name), best.model.values[place], stds[place], units)
    }


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
    fits.sort(key=lambda found: found.cost, reverse=True)
    best_of = {found.model.effects[-1]: found for found in fits if found.model.plausible()}
    return sorted(best_of.values(), key=lambda found: found.cost)


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


def _quietly(name: str) -> None:
    """Report no progress."""


def _alike(
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
        else not _is_other(rival, family) or not enough(rival, best))]
    if not near:
        return []
    held = [(discounted(one.whole(best.model), best.model), one.held_out.samples)
            for one in recordings if one.held_out is not None]
    alike = [rival for rival in near if all(
        as_good(whole, samples, best.model, rival.model, generator) for whole, samples in held)]
    return alike[:_MOST_RIVALS]


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


def _is_other(rival: Fit, family: str) -> bool:
    """Return whether the law of a rival is of another family."""
    return EFFECTS[rival.model.effects[-1]].family != family


def _other_families(family: str, alike: Sequence[Fit]) -> set[str]:
    """Return the families that may be right instead: a probability is that of the family."""
    return {EFFECTS[rival.model.effects[-1]].family for rival in alike} - {family}


def advice(
    names: Sequence[NamedEffect], rivals: Collection[str], verdict: str, touching: bool
) -> str:
    """
    Recommend what to run next.

    Parameters
    ----------
    names : sequence of NamedEffect
        Of the diagnosis.
    rivals : collection of str
        Effects that an experiment may distinguish from them.
    verdict : str
        Of the diagnosis.
    touching : bool
        Whether the environment is touched and left; False if it is permanently attached.

    Returns
    -------
    advice : str
        '' if no question is open.

    """
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
    """
    Recommend what to run where each contact fits a wall of its own.

    Parameters
    ----------
    springs : ndarray, shape (C,)
        K_e of each contact [N/m].

    Returns
    -------
    advice : str
        Two sentences.

    """
    listed = ', '.join(f'{spring:.4g}' for spring in springs[:_LISTED])
    listed += ' ...' if len(springs) > _LISTED else ''
    return (f'Each contact fits a spring and a damper of its own, with K_e = {listed} N/m. '
            'Diagnose contacts of one object at one place together, and each object or place by '
            'itself.')


def what_is_explained(names: Sequence[NamedEffect]) -> str:
    """
    Say how far the library explains a mismatch whose verdict is 'unexplained'.

    Parameters
    ----------
    names : sequence of NamedEffect
        Of the diagnosis.

    Returns
    -------
    sentence : str
        One sentence.

    """
    if not names:
        return 'No effect of the library explains this.'
    verb = 'explains' if len(names) == 1 else 'explain'
    return f'{" and ".join(effect.name for effect in names)} {verb} only a part of this.'


def indistinguishable_pairs(names: Sequence[NamedEffect], rivals: Collection[str]) -> str:
    """
    List which effects cannot be distinguished from which.

    Parameters
    ----------
    names : sequence of NamedEffect
        Of the diagnosis.
    rivals : collection of str
        Those that an experiment may distinguish from them.

    Returns
    -------
    pairs : str
        Such as 'a from b and c; d from e'; '' if there are none.

    """
    pairs = [(effect.name, [other for other in effect.indistinguishable_from if other in rivals])
             for effect in names]
    return '; '.join(f'{name} from {" and ".join(others)}' for name, others in pairs if others)
