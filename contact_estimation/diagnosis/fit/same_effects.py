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

"""Selections of the same effects, for recordings that are prepared differently."""

from __future__ import annotations

from .criteria import enough, leaves_noise
from .exact_laws import prune
from .fitting import Fit, fit
from .selection import is_explained, Selection, weigh
from ..observe.model import Model
from ..observe.prepared_recording import Recordings


def fitted_again(recordings: Recordings, selection: Selection) -> Selection:
    """
    Fit the models of a selection of inexact laws to the same recordings, prepared differently.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together, without a discrepancy.
    selection : Selection
        Of the effects.

    Returns
    -------
    selection : Selection
        Of the same effects.

    """
    return of_model(recordings, selection, selection.best.model)


def with_effects_kept(
    recordings: Recordings, base: Fit, selection: Selection, alike: bool
) -> Selection | None:
    """
    Keep the effects of a selection for the same recordings, prepared differently.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together, without a discrepancy.
    base : Fit
        Recalibrated to them, without effects.
    selection : Selection
        Of the effects.
    alike : bool
        Whether the effects leave nearly as much as before, so that another search would not find
        more; else they must leave only noise.

    Returns
    -------
    selection : Selection or None
        None if a search may find other effects, or if not each of them is needed.

    """
    best = fit(recordings, selection.best.model)
    if not (best.model.effects and best.model.plausible() and enough(base, best)):
        return None
    if not (alike or leaves_noise(best) and is_explained(recordings, base, best)):
        return None
    if prune(recordings, best, selection.rivals)[0].model.effects != best.model.effects:
        return None
    if leaves_noise(best):
        return Selection(recordings, base, best, selection.rivals, selection.evidence)
    return of_model(recordings, selection, best.model)


def of_model(recordings: Recordings, selection: Selection, model: Model) -> Selection:
    """
    Fit a model to recordings in place of the selected one.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together, without a discrepancy.
    selection : Selection
        Of other effects.
    model : Model
        With the effects.

    Returns
    -------
    selection : Selection
        Of the effects of the model.

    """
    carried, best = weigh(recordings, fit(recordings, model))
    base = fit(carried, selection.base.model)
    return selection._replace(recordings=carried, base=base, best=best)
