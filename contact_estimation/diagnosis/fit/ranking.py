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

The next effect is the one that best predicts parts of the recordings that it was not fitted on; of
effects that predict alike, the simplest.
"""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .criteria import ADEQUATE, predicts_enough, SHARE
from .discrepancy import CHANNELS, costs_by_channel, material, noise_by_channel
from .fitting import Fit, fit, fit_to_end
from .invariance import (
    channel_of,
    judged_by_channel,
    left_out_errors,
    Part,
    parts_of,
    share_of,
)
from ..observe.model import Model, names_of
from ..observe.prepared_recording import Recordings
from ...physics import EFFECTS

Array = NDArray[np.float64]

_PROMISING = 0.4  # of the largest gain in the fit, to be assessed
# What a curve that fits almost anything must show.
_FLEXIBLE_SHARE, _FLEXIBLE_HARM = 0.85, 0.01

FLEXIBLE_LEAD = 0.15
"""Share of the misfit by which such a curve must be better than the best law."""


class _Candidate(NamedTuple):
    """
    A fitted candidate.

    `errors` on parts left out have the shape (parts, CHANNELS); `channel` is that by which the
    candidate is judged, None for all.
    """

    found: Fit
    errors: Array
    channel: int | None
    flexible: bool

    @property
    def name(self) -> str:
        return self.found.model.effects[-1]

    @property
    def total(self) -> float:
        return float(self.errors.sum())

    @property
    def size(self) -> int:
        return len(names_of(self.name))


def rank_by_prediction(
    recordings: Recordings, present: Fit, base: Model, found: Sequence[Fit]
) -> list[Fit]:
    """
    Return the candidate that best predicts parts left out, and those that do as well.

    Where the motion lacks something else than the force does, the misfit of the one does not count
    against an effect that shows in the other.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        With a discrepancy.
    present : Fit
        Without the candidates.
    base : Model
        Recalibrated, without effects.
    found : sequence of Fit
        Candidates.

    Returns
    -------
    ranked : list of Fit
        The next effect first; none if the best explains too little.

    """
    groups: dict[int | None, Sequence[Fit]] = {None: found}
    if judged_by_channel(recordings, present.model):
        groups = {channel: [one for one in found if channel_of(one.model.effects[-1]) == channel]
                  for channel in range(CHANNELS)}
    groups = {channel: _promising(recordings, present, group, channel)
              for channel, group in groups.items()}
    if not any(groups.values()):
        return []
    first = fit(recordings, _with_zeros(base, present.model)) if present.model.effects else present
    parts = parts_of(recordings, first)
    before = left_out_errors(recordings, present, parts)
    whole = left_out_errors(recordings, first, parts) if present.model.effects else before
    assessed, taken = list[_Candidate](), list[_Candidate]()
    for channel, group in groups.items():
        candidates = _assess(recordings, group, parts, before, channel)
        assessed += candidates
        best = _choose(candidates, before, parts)
        if best is not None:
            best = _simpler_beside_an_offset(recordings, candidates, best, before, parts)
            of_present = share_of(before, best.errors, parts, before, channel)
            of_whole = share_of(before, best.errors, parts, whole)
            if predicts_enough(of_present, of_whole, _is_zero(best.name) and not best.flexible):
                taken.append(best)
    if not taken:
        return []
    best = min(taken, key=lambda one: one.total)
    most = best.total + ADEQUATE * (float(before.sum()) - best.total)
    rest = sorted((one for one in assessed
                   if one is not best and not one.flexible and one.total <= most),
                  key=lambda one: one.total)
    return [best.found, *(one.found for one in rest)]


def _with_zeros(base: Model, present: Model) -> Model:
    """Add the zeros that are named: what is large beside them is no trifle."""
    for name in present.effects:
        if _is_zero(name):
            base = base.with_effect(name, present.values[present.place(name)])
    return base


def _is_zero(name: str) -> bool:
    return name == 'contact_offset' or EFFECTS[name].family == 'sensor_zero'


def _promising(
    recordings: Recordings, present: Fit, found: Sequence[Fit], channel: int | None
) -> list[Fit]:
    """Leave out candidates that fit too little of a channel to predict enough of it."""
    large = {number for one in recordings for number in material(one, present.model)}
    if channel is not None and channel not in large:
        return []  # trifles that the other channel does not confirm
    columns = slice(None) if channel is None else channel
    before = costs_by_channel(recordings, present)
    misfit = float(np.sum((before - noise_by_channel(recordings, present.model))[columns]))
    gains = [float(np.sum((before - costs_by_channel(recordings, one))[columns]))
             for one in found]
    least = max(SHARE * misfit, _PROMISING * max(gains, default=0.0))
    return [one for one, gain in zip(found, gains) if gain > least]


def _assess(
    recordings: Recordings, found: Sequence[Fit], parts: Sequence[Part], before: Array,
    channel: int | None,
) -> list[_Candidate]:
    """Fit candidates to the end and let them predict parts left out."""
    duration = max(float(one.observed.t[-1]) for one in recordings)
    fits = [fit_to_end(recordings, one._replace(ended=False)) for one in found]
    return [_Candidate(one, left_out_errors(recordings, one, parts, before), channel,
                       is_flexible(one.model, duration))
            for one in fits if one.model.plausible()]


def _choose(
    assessed: Sequence[_Candidate], before: Array, parts: Sequence[Part]
) -> _Candidate | None:
    """Choose the candidate that predicts best, or the simplest of those that are adequate."""
    laws = [one for one in assessed if not one.flexible]
    winner = min(laws, key=lambda one: one.total, default=None)
    curve = min((one for one in assessed if one.flexible), key=lambda one: one.total, default=None)
    if curve is not None:
        share = share_of(before, curve.errors, parts, before, curve.channel)
        columns = slice(None) if curve.channel is None else curve.channel
        noise = sum(float(np.sum(part.noise[columns])) for part in parts)
        misfit = float(np.sum(before[:, columns])) - noise
        lead = (winner.total if winner else float(before.sum())) - curve.total
        if (share.share > _FLEXIBLE_SHARE and share.harm < _FLEXIBLE_HARM
                and lead > FLEXIBLE_LEAD * misfit):
            return curve
    if winner is None:
        return None
    gain = float(before.sum()) - winner.total
    adequate = [one for one in laws if one.total <= winner.total + ADEQUATE * gain]
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
    if 'force_bias' in taken.found.model.effects:
        return taken
    gain = float(before.sum()) - taken.total
    for one in sorted(assessed, key=lambda one: one.total):
        if one.size < taken.size and not one.flexible:
            model = one.found.model.with_effect('force_bias', (0.0,))
            errors = left_out_errors(recordings, fit(recordings, model), parts)
            slack = ADEQUATE * gain if one.size + 1 < taken.size else 0.0
            if float(errors.sum()) <= taken.total + slack:
                return one
    return taken


def is_flexible(model: Model, duration: float) -> bool:
    """
    Return whether the last effect is a curve that follows any slow misfit.

    Parameters
    ----------
    model : Model
        With effects.
    duration : float
        Of the longest recording [s].

    Returns
    -------
    flexible : bool
        If so, more is asked of it than of a law.

    """
    name = model.effects[-1]
    values = EFFECTS[name].Parameters(*model.values[model.place(name)])
    return EFFECTS[name].is_flexible(values, duration)
