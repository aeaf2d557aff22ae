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

"""What is revised once effects are selected: laws too wide, bent out of sight, or superfluous."""

from __future__ import annotations

from typing import Sequence

from .applicable import candidates_in
from .criteria import SHARE
from .discrepancy import has_discrepancy, noise_by_channel
from .exact_laws import BEYOND_DOUBT
from .first_step import fit_without
from .fitting import Fit
from .invariance import left_out_errors
from .order import best as best_of, ranked, ZEROS
from .parts import parts_of
from .search import may_show, Progress, search, search_family
from ..observe.prepared_recording import Recordings
from ...physics import EFFECTS

_OF_WIDER = 0.85  # least share of the gain of a wider law, for one of its family to replace it


def narrowest(recordings: Recordings, base: Fit, best: Fit, progress: Progress) -> Fit:
    """
    Put a law of its family in the place of a wider one that fits little better.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        As fitted.
    base, best : Fit
        Recalibrated, and with effects.
    progress : callable
        Called with the name of each candidate.

    Returns
    -------
    best : Fit
        `best` itself if no law is narrower.

    """
    for name in [one for one in best.model.effects if EFFECTS[one].is_series]:
        rest = fit_without(recordings, best.model, (name,))
        laws = [law for law in candidates_in(recordings, rest.model)
                if EFFECTS[law].family == EFFECTS[name].family and not EFFECTS[law].is_series]
        fits = search(recordings, rest, progress, laws)
        found = best_of(fits, lambda one: one.cost) or best
        sharply = best.cost < best.residual_count and found.cost > best.cost + BEYOND_DOUBT
        if base.cost - found.cost >= _OF_WIDER * (base.cost - best.cost) and not sharply:
            best = found
    return best


def as_shown(recordings: Recordings, best: Fit, progress: Progress) -> Fit:
    """
    Put another of its family in the place of a law that later ones have bent out of sight.

    Parameters
    ----------
    recordings, best, progress
        As of `narrowest`.

    Returns
    -------
    best : Fit
        `best` itself if all may show.

    """
    for name in best.model.effects:
        if may_show(recordings, best.model, name):
            continue
        best = _of_family(recordings, best, search_family(recordings, best.model, name, progress))
    return best


def _of_family(recordings: Recordings, best: Fit, laws: Sequence[Fit]) -> Fit:
    """Return the law that predicts parts left out best; `best` if there is none."""
    if len(laws) < 2 or not has_discrepancy(recordings):
        return next(iter(laws), best)
    parts = parts_of(recordings, best)
    return ranked(laws, lambda one: float(left_out_errors(recordings, one, parts).sum()))[0]


def without_trifles(recordings: Recordings, best: Fit) -> Fit:
    """
    Drop effects that later ones have made superfluous; a law may not predict without a zero.

    Parameters
    ----------
    recordings, best
        As of `narrowest`.

    Returns
    -------
    best : Fit
        `best` itself if none is.

    """
    for name in [one for one in best.model.effects[:-1] if one not in ZEROS]:
        rest = fit_without(recordings, best.model, (name,))
        misfit = rest.cost - float(noise_by_channel(recordings, best.model).sum())
        if rest.cost - best.cost < SHARE * misfit:
            return without_trifles(recordings, rest)
    return best
