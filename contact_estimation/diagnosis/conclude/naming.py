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

from .location import locate
from .probability import probabilities, probability_in_form, probability_of
from .result import NamedEffect, Value
from .rivals import indistinguishable, is_other, other_families
from .shares import Shares
from ..fit.discrepancy import has_discrepancy
from ..fit.fitting import Fit, fit
from ..fit.order import prior, ranked_by
from ..fit.selection import Selection
from ..observe.model import Model, names_of
from ..observe.prepared_recording import PreparedRecording, Recordings
from ...parameters.specification import specifications
from ...physics import EFFECTS

Array = NDArray[np.float64]

_LISTED = 8  # contacts
_UNLIKELY = 0.3  # probability below which a name is none; surely one of three families has more


class Names(NamedTuple):
    """
    Name the effects of a model, with the effects they may be confused with.

    Attributes
    ----------
    effects : list of NamedEffect
        First the one whose omission costs most.
    rivals : dict of str to Model
        Fitted models with an indistinguishable effect in the place of a named one, by its name.
    unlikely : list of str
        Names that are none, even together with what they cannot be distinguished from.

    """

    effects: list[NamedEffect]
    rivals: dict[str, Model]
    unlikely: list[str]


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
        return Names([], {}, [])
    effects, rival_models = [], {}
    exact = not has_discrepancy(recordings)
    likely = _probabilities(shares, exact)
    likely.update({name: probability_in_form(share) for name, share in shares.in_form.items()})
    told = selection.marked
    if selection.mark is not None and told in best.model.effects:
        likely[told] = probability_of(1.0 - selection.mark.spread)
    for name in ranked_by(best.model.effects, lambda name: -shares.of[name].share, prior):
        dropped = fit(recordings, best.model.without(name), steps=8)
        alike = indistinguishable(best, name, selection, recordings, generator)
        cls, share = EFFECTS[name], shares.of[name]
        # Where no law is exact, no experiment tells those of a family: it would be like none.
        others = alike if exact else [rival for rival in alike if is_other(rival, cls.family)]
        rival_models.update({rival.model.effects[-1]: rival.model for rival in others})
        effects.append(NamedEffect(
            name, cls.family, cls.port, cls.equation,
            likely[name] / (1.0 + exact * len(other_families(cls.family, alike))),
            share.share, share.interval, shares.on_parts(name), _values(best, name, stds),
            [rival.model.effects[-1] for rival in alike],
            locate(shown, dropped.model, cls),
            shares.in_form[name].share if name in shares.in_form else None,
            selection.mark if name == told else None, shares.of_rest(name)))
    unlikely = [name for name in best.model.effects if likely[name] < _UNLIKELY]
    return Names(effects, rival_models, unlikely)


def _probabilities(shares: Shares, exact: bool) -> dict[str, float]:
    """
    Return the probability of each name.

    That of a law which predicts more of what the zeros leave than of the whole misfit is the mean
    of both: of laws beside zeros as many are right.
    """
    names = list(shares.of)
    likely = dict(zip(names, probabilities(
        [shares.of_channel[name] for name in names], [shares.beside[name] for name in names],
        shares.left, exact)))
    if shares.beside_zeros is not None:
        for name, probability in _probabilities(shares.beside_zeros, exact).items():
            likely[name] = max(likely[name], 0.5 * (likely[name] + probability))
    return likely


def _values(best: Fit, name: str, stds: Array) -> dict[str, Value]:
    place = best.model.place(name)
    units = [spec.unit for spec in specifications(EFFECTS[name].Parameters)]
    return {
        parameter: Value(value, float(std), unit) for parameter, value, std, unit in zip(
            names_of(name), best.model.values[place], stds[place], units)
    }


def advice(
    names: Sequence[NamedEffect], rivals: Collection[str], verdict: str, touching: bool,
    rubs: bool = False,
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
    rubs : bool
        Whether its damping may as well be dry friction.

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
    if rubs:
        return ('At one speed, dry friction F_c is the same as a damping F_c / abs(v). Repeat the '
                'same motion at half and at twice the speed: the force of a damper follows it.')
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


def listed(names: Sequence[str]) -> str:
    """
    List names in words.

    Parameters
    ----------
    names : sequence of str
        At least one.

    Returns
    -------
    words : str
        Such as 'a, b and c'.

    """
    *others, last = names
    return f'{", ".join(others)} and {last}' if others else last


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
    return '; '.join(f'{name} from {listed(others)}' for name, others in pairs if others)
