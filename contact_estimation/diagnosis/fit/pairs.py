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
Pairs of an elastic law and a loss, where neither predicts parts left out alone.

The force of a soft material neither grows in proportion to depth nor returns the same way. While
the one is missing, the fit bends the other to replace it, and its prediction fails.
"""

from __future__ import annotations

from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .applicable import candidates_in
from .candidate import assess, Candidate, fitted_errors
from .criteria import ADEQUATE, predicts_enough, SHARE_OF_WHOLE
from .discrepancy import noise_by_channel
from .fitting import Fit
from .invariance import left_out_errors
from .order import ranked, ZEROS
from .parts import Part
from .search import is_curve, search
from .share import share_of
from ..observe.prepared_recording import Recordings
from ...physics import EFFECTS

Array = NDArray[np.float64]

_ELASTIC, _LOSSES = 'elastic_law', ('friction', 'hysteresis', 'relaxation', 'damping_law')
_LEAST_FIT = 0.5  # share of the misfit that a pair must fit, to be assessed
_ASSESSED = 8
_LEAST = 0.5  # share of the misfit that it must predict
_LEFT, _LEAD = 0.3, 0.15  # shares: left by a zero that may be in the place of a pair; lead over it


def is_pair(names: Sequence[str]) -> bool:
    """
    Return whether effects are an elastic law and a loss, zeros of sensor and surface aside.

    Parameters
    ----------
    names : sequence of str
        Effects of a model.

    Returns
    -------
    pair : bool
        If so, each may be bent to replace the other.

    """
    families = [EFFECTS[name].family for name in names if name not in ZEROS]
    return (len(families) == 2 and families.count(_ELASTIC) == 1
            and any(family in _LOSSES for family in families))


def pairs_that_predict(
    recordings: Recordings, present: Fit, found: Sequence[Fit], parts: Sequence[Part],
    before: Array, zero: Candidate | None,
) -> list[Candidate]:
    """
    Return the pairs of an elastic law and a loss that predict parts left out, the simplest first.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        With a discrepancy.
    present : Fit
        Without laws.
    found : sequence of Fit
        Single candidates, of which none predicts enough.
    parts : sequence of Part
        Left out in turn.
    before : ndarray, shape (parts, CHANNELS)
        Errors of the present model.
    zero : Candidate or None
        That predicts enough: a constant replaces a part of whatever is missing.

    Returns
    -------
    pairs : list of Candidate
        The best with its loss as last effect, then others with the same elastic law. Without
        either of its laws the best predicts clearly less, and so does the zero.

    """
    squares = float(before.sum())
    misfit = squares - sum(float(part.noise.sum()) for part in parts)
    least = _LEAST
    if zero is not None:
        left = (zero.total - squares + misfit) / misfit
        if left < _LEFT:
            return []
        least = max(_LEAST, 1.0 - left + _LEAD)
    elastic = [one for one in found if EFFECTS[one.model.effects[-1]].family == _ELASTIC]
    losses = [name for name in candidates_in(recordings, present.model)
              if EFFECTS[name].family in _LOSSES]
    pairs = [pair for law in elastic
             for pair in search(recordings, law, lambda name: None, losses)]
    excess = present.cost - float(noise_by_channel(recordings, present.model).sum())
    fitting = ranked((pair for pair in pairs if present.cost - pair.cost > _LEAST_FIT * excess),
                     lambda pair: pair.cost)
    tried = assess(recordings, fitting[:_ASSESSED], parts, before, None)
    assessed = ranked((pair for pair in tried if not pair.flexible), lambda pair: pair.total)
    if not assessed:
        return []
    best = assessed[0]
    share = share_of(before, best.errors, parts, before)
    if share.share < least or not predicts_enough(share, share):
        return []
    most = best.total + ADEQUATE * (squares - best.total)
    adequate = [pair for pair in assessed if pair.total <= most]
    pair = min(adequate, key=lambda pair: len(pair.found.model.values))
    law, loss = pair.found.model.effects[-2:]
    alone = (_alone(recordings, found, name, parts, before) for name in (law, loss))
    if any(errors - pair.total <= SHARE_OF_WHOLE * misfit for errors in alone):
        return []
    if any(float(fitted_errors(one, parts).sum()) <= pair.expected for one in found
           if not is_curve(recordings, one)):
        return []  # one law may be all, though parts of a single cycle do not confirm it
    others = (one for one in adequate if one is not pair and law in one.found.model.effects)
    return [pair, *others]


def _alone(
    recordings: Recordings, found: Sequence[Fit], name: str, parts: Sequence[Part], before: Array
) -> float:
    """Return the error of one law alone on parts left out, at most that of the present model."""
    fits = [one for one in found if one.model.effects[-1] == name]
    errors = [float(left_out_errors(recordings, one, parts, before).sum()) for one in fits]
    return min([float(before.sum()), *errors])
