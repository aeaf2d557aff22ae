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

"""Alternatives to laws that predict parts of the recordings, but not the held-out data."""

from __future__ import annotations

from typing import Iterator

from .decision import decide_without, Decision
from .shares import shares_of
from ..fit.criteria import EXPLAINED
from ..fit.discrepancy import has_discrepancy
from ..fit.first_step import fit_without
from ..fit.fitting import Fit
from ..fit.order import ZEROS
from ..fit.search import Progress, search_family
from ..fit.selection import Selection
from ..observe.prepared_recording import Recordings
from ...physics import EFFECTS


def alternatives(
    selection: Selection, decision: Decision, whole: Recordings, progress: Progress
) -> Iterator[Decision]:
    """
    Decide for something else than what the held-out data contradict.

    A law may predict only beside the zeros that its rig has; it may not last, as a bias that
    settles is none at the start; or it is none, and stood before one that fits nearly as well.

    Parameters
    ----------
    selection : Selection
        As selected.
    decision : Decision
        That is contradicted.
    whole : sequence of PreparedRecording
        The recordings with their held-out parts.
    progress : callable
        Called with a description of each stage.

    Yields
    ------
    decision : Decision
        The nearest first.

    """
    zeroed = beside_zeros(selection, decision)
    if zeroed is not None:
        yield zeroed
    yield from in_family(decision.selection, decision, progress)
    if has_discrepancy(decision.selection.recordings):
        names = set(decision.best.model.effects)
        yield decide_without(decision.selection, names, whole, progress)


def beside_zeros(selection: Selection, decision: Decision) -> Decision | None:
    """
    Decide for the same laws beside the zeros with which they were selected.

    Parameters
    ----------
    selection : Selection
        As selected.
    decision : Decision
        Without zeros that were doubtful.

    Returns
    -------
    decision : Decision or None
        None if no zero had been dropped.

    """
    named, selected = decision.best.model.effects, selection.best.model
    zeros = [name for name in selected.effects if name in ZEROS and name not in named]
    if not zeros or not set(named) <= set(selected.effects):
        return None
    others = [name for name in selected.effects if name not in (*named, *zeros)]
    return _decision(selection, fit_without(selection.recordings, selected, others))


def in_family(
    selection: Selection, decision: Decision, progress: Progress
) -> Iterator[Decision]:
    """
    Decide for another law of its family in the place of the last effect.

    Parameters
    ----------
    selection : Selection
        As selected.
    decision : Decision
        With the effect.
    progress : callable
        Called with the name of each candidate.

    Yields
    ------
    decision : Decision
        With another that explains most of the misfit on parts left out, the best fit first; of a
        curve as much is asked as in a selection.

    """
    best = decision.best.model
    for found in search_family(selection.recordings, best, best.effects[-1], progress):
        other, name = _decision(selection, found), found.model.effects[-1]
        shares = other.shares
        if shares is not None and shares.explained >= (
                EFFECTS[name].least_share if shares.is_flexible(name) else EXPLAINED):
            yield other


def _decision(selection: Selection, best: Fit) -> Decision:
    """Decide for a model with effects."""
    shares = shares_of(selection.recordings, selection.base.model, best.model)
    return Decision(selection._replace(best=best), best, shares.explained < EXPLAINED, 0.0, shares)
