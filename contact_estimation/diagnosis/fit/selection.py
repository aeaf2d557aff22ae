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
Selection of the effects that recordings support: forward search, exchange, pruning.

An effect is taken only if its gain is significant and a fair share of the unexplained misfit, see
`criteria`.
"""

from __future__ import annotations

from typing import NamedTuple

from .criteria import enough, noise_scale, penalty, THRESHOLD
from .fitting import Fit, fit
from .search import candidates_for, Progress, search
from ..observe.prepared_recording import Recordings

_MOST_EFFECTS = 3
_EXCHANGE_GAIN = 10.0  # cost, in that of the noise

Rivals = dict[str, list[Fit]]


class Selection(NamedTuple):
    """
    The result of a selection.

    Attributes
    ----------
    base : Fit
        Recalibrated, without effects.
    best : Fit
        With the effects taken; `base` itself if none was.
    rivals : dict of str to list of Fit
        For each effect taken, fits with another in its place, best first.
    evidence : dict of str to float
        Share of the cost that one effect alone takes away, by name.

    """

    base: Fit
    best: Fit
    rivals: Rivals
    evidence: dict[str, float]


def select(
    recordings: Recordings, base: Fit,
    progress: Progress = lambda name: None, most: int = _MOST_EFFECTS, with_robot: bool = True,
) -> Selection:
    """
    Select the effects that recordings ask for.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    base : Fit
        Recalibrated model without effects.
    progress : callable
        Called with the name of each candidate.
    most : int
        Effects that may be taken.
    with_robot : bool
        Whether robot effects are candidates, if there is a robot.

    Returns
    -------
    selection : Selection
        The effects taken, and their rivals.

    """
    with_robot = with_robot and any(
        recording.observed.reference is not None for recording in recordings)
    best, evidence = base, {}
    rivals: Rivals = {}
    for count in range(most):
        if count > 0 and best.cost < best.residual_count * (1.0 + 0.5 * THRESHOLD):
            break  # the rest is noise
        fits = search(recordings, best, candidates_for(best.model, with_robot), progress)
        if count == 0:
            evidence = {found.model.effects[-1]: 1.0 - found.cost / base.cost for found in fits}
        if not fits or not enough(best, fits[0]):
            break
        best = fits[0]
        rivals[best.model.effects[-1]] = fits[1:]
        if count > 0:
            best, rivals = exchange(recordings, best, rivals, with_robot, progress)
    best, rivals = prune(recordings, best, rivals)
    best = fit(recordings, best.model) if best.model.effects else base
    return Selection(base, best, rivals, evidence)


def exchange(
    recordings: Recordings, best: Fit, rivals: Rivals, with_robot: bool,
    progress: Progress,
) -> tuple[Fit, Rivals]:
    """
    Revise early choices: replace each effect by any other beside the rest.

    Parameters
    ----------
    recordings, best, rivals, with_robot, progress
        As in `select`.

    Returns
    -------
    best : Fit
        No single exchange makes it better.
    rivals : dict
        For each effect, what could stand in its place.

    """
    rivals = dict(rivals)
    for name in best.model.effects[:-1]:
        rest = fit(recordings, best.model.without(name))
        fits = search(recordings, rest, candidates_for(rest.model, with_robot), progress)
        # A wider law always fits a little better: it is charged for its parameters.
        least = _EXCHANGE_GAIN + (penalty(fits[0].model) - penalty(best.model) if fits else 0.0)
        if fits and fits[0].cost < best.cost - noise_scale(best) * least:
            best = fits[0]
            rivals.pop(name, None)
            rivals[best.model.effects[-1]] = fits[1:]
        else:
            rivals[name] = [found for found in fits if found.model.effects[-1] != name]
    return best, rivals


def prune(recordings: Recordings, best: Fit, rivals: Rivals) -> tuple[Fit, Rivals]:
    """
    Drop superfluous effects; parameters as `exchange`.

    Returns
    -------
    best : Fit
        Without any of its effects it would be significantly worse.
    rivals : dict
        Of the remaining effects.

    """
    while len(best.model.effects) > 1:
        shorter = [fit(recordings, best.model.without(name)) for name in best.model.effects]
        least = min(shorter, key=lambda found: found.cost)
        if enough(least, best):
            break
        best = least
    return best, {name: rivals.get(name, []) for name in best.model.effects}
