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
Laws that hold in form alone: their size differs from part to part.

Where the damping of a contact depends on the speed of its impact, or the motion of a wall fades,
no law with constant parameters predicts a part left out. The form of one may: with all that shapes
it fixed by the other parts, it explains each part by its size there. That spends one number a
part, so it must explain most of every part, and clearly more than effects of other families that
are given the same freedom; all the more where one size for all parts predicts nothing.
"""

from __future__ import annotations

from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .candidate import Candidate
from .invariance import errors_with_own_size
from .order import prior, ranked, ranked_by
from .parts import Part
from .share import Share, share_of
from .zeros import resembles_zero
from ..observe.prepared_recording import Recordings
from ...physics import EFFECTS

Array = NDArray[np.float64]

_LEAST, _LEAST_OF_PART = 0.5, 0.3  # share of the misfit: lower end for all parts, and of each part
_LEAST_PREDICTED = 0.1  # share of the squared error on parts left out, with one size for all
_LEAD = 0.15  # share of the misfit, before the best effect of another family
_SURE, _SURE_LEAD = 0.75, 0.3  # of one that predicts nothing with one size: its parts are too few


def holds_in_form(share: Share) -> bool:
    """
    Return whether a law holds in form.

    Parameters
    ----------
    share : Share
        Of the misfit that it explains if its size is free on each part.

    Returns
    -------
    holds : bool
        It explains most of the misfit, and some of every part.

    """
    return share.interval[0] >= _LEAST and float(np.min(share.parts)) >= _LEAST_OF_PART


def law_in_form(
    recordings: Recordings, candidates: Sequence[Candidate], parts: Sequence[Part], before: Array,
) -> Candidate | None:
    """
    Return the simplest law that holds in form and leads the other families.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        With a discrepancy.
    candidates : sequence of Candidate
        Of which none predicts enough with constant parameters.
    parts : sequence of Part
        Left out in turn.
    before : ndarray, shape (parts, CHANNELS)
        Errors of the present model.

    Returns
    -------
    law : Candidate or None
        Not a zero, and not a curve.

    """
    shares = [share_of(before, errors_with_own_size(recordings, one.found, parts), parts, before,
                       one.channel) for one in candidates]
    most = (1.0 - _LEAST_PREDICTED) * float(before.sum())
    holding = [(one, share) for one, share in zip(candidates, shares)
               if not one.flexible and not resembles_zero(one.name) and holds_in_form(share)
               and (one.total <= most or float(np.min(share.parts)) >= _SURE)]
    if not holding:
        return None
    best, leading = ranked_by(
        holding, lambda pair: -pair[1].share, lambda pair: prior(pair[0].name))[0]
    family = EFFECTS[best.name].family
    others = [share.share for one, share in zip(candidates, shares)
              if EFFECTS[one.name].family != family]
    if leading.share < max(others, default=0.0) + (_LEAD if best.total <= most else _SURE_LEAD):
        return None
    alike = [one for one, share in holding
             if EFFECTS[one.name].family == family and share.share > leading.share - _LEAD]
    return min(ranked(alike, lambda one: one.total), key=lambda one: one.size)
