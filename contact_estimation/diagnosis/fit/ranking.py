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
Ranking of candidates by prediction, where no law is exact.

The next effect is the one of the least expected error on parts of the recordings that it was not
fitted on; of effects that are alike, the simplest. It must predict enough of these parts.
"""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .applicable import is_single_stroke, least_worth_a_name
from .candidate import assess, Candidate
from .criteria import ADEQUATE, is_sure_of_little, OF_LITTLE, predicts_enough, SHARE
from .discrepancy import CHANNELS, costs_by_channel, material, noise_by_channel
from .fitting import Fit
from .form import law_in_form
from .invariance import channel_by_gain, judged_by_channel, left_out_errors, ROBOT
from .marks import Mark
from .order import best as best_of, prior, ranked, ranked_by, ZEROS
from .pairs import pairs_that_predict
from .parts import counts_of, evened, parts_of
from .share import share_of
from .simplest import adequate, simplest_curve
from .zeros import is_zero, resembles_zero, without_laws, Zeros
from ..observe.prepared_recording import Recordings

Array = NDArray[np.float64]

_PROMISING, _ASSESSED = 0.4, 12  # of the largest gain in the fit, to be assessed; at most so many
_LITTLE = 1.25  # times the least discrepancy that is worth a name, in the motion alone
_TRACE = 0.35  # times it: less is in every instrument, whatever explains it
_BESIDE_ZEROS = 3  # laws that are tried for each offset that the model lacks
_WEAK = 0.15  # share of the misfit that one size for all parts fits, of a law that holds in form


class Ranking(NamedTuple):
    """
    Candidates for the next effect.

    Attributes
    ----------
    found : list of Fit
        The next effect first, then those that predict as well; none if the best explains too
        little.
    in_form : bool
        Whether the first holds in form alone: its size differs from part to part.
    pair : tuple of str
        The last two effects of the first, if they predict only together.
    mark : Mark or None
        What tells the first, if it predicts too little.

    """

    found: list[Fit]
    in_form: bool = False
    pair: tuple[str, ...] = ()
    mark: Mark | None = None


def rank_by_prediction(
    recordings: Recordings, present: Fit, found: Sequence[Fit]
) -> Ranking:
    """
    Rank candidates by their prediction of parts left out.

    Where the motion lacks something else than the force does, the misfit of the one does not count
    against an effect that shows in the other.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        With a discrepancy.
    present : Fit
        Without the candidates.
    found : sequence of Fit
        Candidates.

    Returns
    -------
    ranking : Ranking
        Of the candidates.

    """
    groups: dict[int | None, Sequence[Fit]] = {None: found}
    if judged_by_channel(recordings, present.model):
        channels = [_channel(recordings, present, one) for one in found]
        groups = {channel: [one for one, its in zip(found, channels) if its == channel]
                  for channel in (*range(CHANNELS), None)}
    first = without_laws(recordings, present.model) if present.model.effects else present
    parts = parts_of(recordings, first)
    parts, whole = evened(parts, left_out_errors(recordings, first, parts))
    counts = counts_of(parts, len(present.residuals))
    promising = {channel: _promising(recordings, present, group, counts, channel, SHARE)
                 for channel, group in groups.items()}
    only_zeros = not set(present.model.effects) - set(ZEROS)
    if not any(promising.values()) and not only_zeros:
        return Ranking([])
    before = left_out_errors(recordings, present, parts) if present.model.effects else whole
    assessed, taken = list[Candidate](), list[Candidate]()
    if any(promising.values()):
        zeros = Zeros.of(recordings, present, first, parts, before, whole)
        for channel, group in promising.items():
            candidates = assess(recordings, group, parts, before, channel)
            if _is_little(recordings, present, channel):
                candidates = _sure_of_little(recordings, present, candidates, zeros, before)
            assessed += candidates
            enough = first_that_predicts(recordings, candidates, zeros, before, whole)
            taken += [] if enough is None else [enough]
    best = _best(taken, float(before.sum()))
    if best is None and only_zeros:  # only the main misfit is worth a law that holds in form alone
        for channel, every in groups.items():
            weak = [one for one in _promising(recordings, present, every, counts, channel, _WEAK)
                    if all(one is not other for other in promising[channel])]
            assessed += assess(recordings, weak, parts, before, channel)
        law = law_in_form(recordings, assessed, parts, before)
        if law is not None:
            return Ranking([law.found], True)
    worth = only_zeros and material(recordings, present.model)
    if worth and (best is None or _takes_a_zero(present, best)):
        pairs = pairs_that_predict(recordings, present, found, parts, before, best)
        if pairs:
            fits = [pair.found for pair in pairs]
            return Ranking(fits, pair=fits[0].model.effects[-2:])
    if best is None:
        return Ranking([])
    rest = _others(assessed, best, float(before.sum()))
    return Ranking([best.found, *(one.found for one in rest)])


def _channel(recordings: Recordings, present: Fit, found: Fit) -> int | None:
    gain = costs_by_channel(recordings, present) - costs_by_channel(recordings, found)
    return channel_by_gain(found.model.effects[-1], gain)


def _best(taken: Sequence[Candidate], before: float) -> Candidate | None:
    """Return the best of the channels' candidates; of curves the simplest that is adequate."""
    best = best_of(taken, lambda one: one.expected)
    return simplest_curve(taken, before) if best is not None and best.flexible else best


def _others(
    assessed: Sequence[Candidate], best: Candidate, before: float
) -> list[Candidate]:
    """List the others that predict about as well as the best; no curve beside a law."""
    most = best.total + ADEQUATE * (before - best.total)
    rest = (one for one in assessed
            if one.name != best.name and one.flexible <= best.flexible and one.total <= most)
    return ranked(rest, lambda one: one.total)


def first_that_predicts(
    recordings: Recordings, candidates: Sequence[Candidate], zeros: Zeros, before: Array,
    whole: Array,
) -> Candidate | None:
    """
    Take the best candidate, or the best zero, if it predicts enough; else one beside the zeros.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        With a discrepancy.
    candidates : sequence of Candidate
        For the next effect.
    zeros : Zeros
        Beside the present model.
    before, whole : ndarray, shape (parts, CHANNELS)
        Errors of the present and of the recalibrated model.

    Returns
    -------
    candidate : Candidate or None
        With the zeros that it needs; None if none predicts enough.

    """
    for laws in (candidates, [one for one in candidates if resembles_zero(one.name)]):
        for best in adequate(recordings, laws, before, zeros.parts):
            of_present = share_of(before, best.errors, zeros.parts, before, best.channel)
            of_whole = share_of(before, best.errors, zeros.parts, whole)
            if predicts_enough(of_present, of_whole, is_zero(best.name) and not best.flexible):
                beside = best if resembles_zero(best.name) else zeros.beside(best)
                if beside is not None:
                    return beside
    # Where neither a law nor an offset predicts enough alone, both together may.
    laws = [one for one in candidates if not one.flexible and not resembles_zero(one.name)]
    for one in ranked(laws, lambda one: one.total)[:_BESIDE_ZEROS * len(zeros.names)]:
        beside = zeros.beside(one)
        if beside is not None and len(beside.found.model.effects) > len(one.found.model.effects):
            return beside
    return None


def _takes_a_zero(present: Fit, best: Candidate) -> bool:
    """Return whether a candidate is, or has beside it, a zero that the model lacked."""
    added = best.found.model.effects[len(present.model.effects):]
    return any(resembles_zero(name) for name in added)


def _promising(
    recordings: Recordings, present: Fit, found: Sequence[Fit], counts: Array,
    channel: int | None, least_share: float,
) -> list[Fit]:
    """
    Leave out candidates that fit too little of a channel to predict enough of it.

    A part with a single event, such as a drive at its stop, outweighs no other here either.
    """
    if _is_little(recordings, present, channel):
        least_share = OF_LITTLE
    columns = slice(None) if channel is None else channel
    before = costs_by_channel(recordings, present, counts)
    noise = noise_by_channel(recordings, present.model, counts)
    misfit = float(np.sum((before - noise)[columns]))
    gains = [float(np.sum((before - costs_by_channel(recordings, one, counts))[columns]))
             for one in found]
    least = max(least_share * misfit, _PROMISING * max(gains, default=0.0))
    order = ranked_by(range(len(found)), lambda k: -gains[k], lambda k: prior(found[k].name))
    return [found[k] for k in sorted(order[:_ASSESSED]) if gains[k] > least]


def _is_little(recordings: Recordings, present: Fit, channel: int | None) -> bool:
    """Return whether a channel lacks little beside the force, which no other channel confirms."""
    confirmed = channel is None and any(one.observed.reference is not None for one in recordings)
    least = _LITTLE if channel == ROBOT else least_worth_a_name(recordings)
    return not confirmed and (channel or 0) not in material(recordings, present.model, least)


def _sure_of_little(
    recordings: Recordings, present: Fit, candidates: Sequence[Candidate], zeros: Zeros,
    before: Array,
) -> list[Candidate]:
    """Keep what explains nearly all of the little that shows; in the motion alone not of less."""
    if is_single_stroke(recordings) or not material(recordings, present.model, _TRACE):
        return []
    large = material(recordings, present.model)
    return [one for one in candidates
            if (one.channel != ROBOT or ROBOT in large) and _is_sure(one, zeros, before)]


def _is_sure(one: Candidate, zeros: Zeros, before: Array) -> bool:
    """Return whether a law explains nearly all of the little that shows, beside the zeros too."""
    if one.flexible or resembles_zero(one.name):
        return False
    shares = (share_of(before, one.errors, zeros.parts, before, one.channel),
              zeros.share_beside(one))
    return all(map(is_sure_of_little, shares))
