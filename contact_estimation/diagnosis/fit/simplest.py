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
The simplest of the candidates that predict about as well as the best.

A curve that fits almost anything must predict more than any law; a law with fewer parameters is
taken where it lacks little.
"""

from __future__ import annotations

from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .candidate import Candidate
from .criteria import ADEQUATE
from .fitting import fit
from .invariance import left_out_errors
from .order import best, is_tie, ranked
from .parts import Part
from .share import share_of
from .zeros import resembles_zero
from ..observe.prepared_recording import Recordings
from ...physics import EFFECTS

Array = NDArray[np.float64]

FLEXIBLE_LEAD = 0.15
"""Share of the misfit by which a curve that fits almost anything must be better than a law."""

_OF_LAW = 0.8  # share of the gain of a series, or of a law, that what replaces it must have
_FLEXIBLE_HARM = 0.01  # most harm of a curve that fits almost anything
# Of a spring the same as a force; at constant speed to and fro likewise.
_LIKE_A_BIAS = ('contact_offset', 'asymmetric_damping')
_OF_TIME = ('wall_motion', 'sensor_zero')  # families of curves that follow time alone


def adequate(
    recordings: Recordings, assessed: Sequence[Candidate], before: Array, parts: Sequence[Part]
) -> list[Candidate]:
    """
    List the best candidate, or the simplest of those that are adequate, then the others.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        With a discrepancy.
    assessed : sequence of Candidate
        For the next effect.
    before : ndarray, shape (parts, CHANNELS)
        `left_out_errors` without it.
    parts : sequence of Part
        For the noise.

    Returns
    -------
    candidates : list of Candidate
        None where a curve of time alone predicts so much more than any law that it is none.

    """
    laws = [one for one in assessed if not one.flexible]
    winner = best(laws, _total)
    curve = simplest_curve(assessed, float(before.sum()))
    if curve is not None and _leads(curve, winner, before, parts):
        share = share_of(before, curve.errors, parts, before, curve.channel)
        if share.share > EFFECTS[curve.name].least_share and share.harm < _FLEXIBLE_HARM:
            return [_simpler_beside_an_offset(recordings, laws, curve, before, parts)]
        family = EFFECTS[curve.name].family
        if family in _OF_TIME and (winner is None or family != EFFECTS[winner.name].family):
            return []
    if winner is None:
        return []
    ordered = ranked(laws, lambda one: one.expected)
    most = (1.0 - ADEQUATE) * ordered[0].expected + ADEQUATE * float(before.sum())
    listed = [one for one in ordered if one.expected <= most]
    first = min(listed, key=lambda one: one.size, default=ordered[0])
    first = _bias_instead(laws, first)
    first = _instead_of_series(laws, first, float(before.sum()))
    first = _simpler_beside_an_offset(recordings, laws, first, before, parts)
    return [first, *(one for one in listed if one is not first)]


def simplest_curve(assessed: Sequence[Candidate], before: float) -> Candidate | None:
    """
    Return the simplest of the curves that predict about as well as the best.

    Parameters
    ----------
    assessed : sequence of Candidate
        Laws among them too.
    before : float
        Error without them.

    Returns
    -------
    curve : Candidate or None
        None if there is none.

    """
    curves = [one for one in assessed if one.flexible]
    least = min((one.total for one in curves), default=0.0)
    alike = (one for one in curves if one.total <= least + ADEQUATE * (before - least))
    return min(ranked(alike, _total), key=lambda one: one.size, default=None)


def _leads(
    curve: Candidate, winner: Candidate | None, before: Array, parts: Sequence[Part]
) -> bool:
    """Return whether a curve predicts so much more than the best law that none may be right."""
    columns = slice(None) if curve.channel is None else curve.channel
    noise = sum(float(np.sum(part.noise[columns])) for part in parts)
    misfit = float(np.sum(before[:, columns])) - noise
    without = winner.total if winner else float(before.sum())
    return without - curve.total > FLEXIBLE_LEAD * misfit


def _bias_instead(laws: Sequence[Candidate], winner: Candidate) -> Candidate:
    """Return a bias that fits an attached wall as well as another offset does."""
    if winner.found.model.nominal.environment.unilateral or winner.name not in _LIKE_A_BIAS:
        return winner
    most = (1.0 + ADEQUATE) * winner.found.cost
    return next((one for one in laws
                 if one.name == 'force_bias' and one.found.cost <= most), winner)


def _instead_of_series(
    laws: Sequence[Candidate], winner: Candidate, before: float
) -> Candidate:
    """Return the best law of the family of a series, if one predicts most of what that does."""
    if not EFFECTS[winner.name].is_series:
        return winner
    most = winner.total + (1.0 - _OF_LAW) * (before - winner.total)
    family = EFFECTS[winner.name].family
    return best((one for one in laws if not EFFECTS[one.name].is_series
                 and EFFECTS[one.name].family == family and one.total <= most), _total) or winner


def _simpler_beside_an_offset(
    recordings: Recordings, assessed: Sequence[Candidate], taken: Candidate, before: Array,
    parts: Sequence[Part],
) -> Candidate:
    """Return a simpler law if it predicts as well beside a bias, which comes next."""
    if 'force_bias' in taken.found.model.effects:
        return taken
    gain = float(before.sum()) - taken.total
    for one in ranked(assessed, _total):
        # A clearance and a bias are two zeros: they replace a law only if the one does already.
        weak = resembles_zero(one.name) and one.total > taken.total + (1.0 - _OF_LAW) * gain
        if one.size < taken.size and not one.flexible and not weak:
            model = one.found.model.with_effect('force_bias', (0.0,))
            errors = left_out_errors(recordings, fit(recordings, model), parts)
            slack = ADEQUATE * gain if one.size + 1 < taken.size else 0.0
            total, most = float(errors.sum()), taken.total + slack
            if total <= most or is_tie(total, most):
                return one
    return taken


def _total(one: Candidate) -> float:
    return one.total
