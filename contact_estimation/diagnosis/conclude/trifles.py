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

"""What is too little beside the force to be worth a name."""

from __future__ import annotations

import numpy as np

from .shares import Shares
from ..fit.applicable import is_single_stroke, least_worth_a_name
from ..fit.criteria import EXPLAINED, OF_LITTLE, SURELY_MOST
from ..fit.discrepancy import correlation_time, has_discrepancy, material, weighed
from ..fit.first_step import fit_without
from ..fit.fitting import Fit
from ..fit.order import ZEROS
from ..observe.prepared_recording import Recordings
from ..observe.residuals import residuals
from ...physics import EFFECTS

_TINY = 0.2  # of the discrepancy that is worth a name, below which a robot's steps show
_SMALL = 0.5  # of the discrepancy that is worth a name where laws may be inexact
_OF_STEPS = 0.5  # of a sample: the mean delay of a command that is held for one
_CORRELATED = 8.0  # neighbouring residuals that tell as much as one: no white noise


def is_trifle(recordings: Recordings, shares: Shares, name: str) -> bool:
    """
    Return whether a name takes away little beside the force, and less than the noise.

    With long recordings every imperfection of a rig is significant. One that is the same on all
    parts is a law however small if all names together leave little, or if it surely explains most.
    Of a robot, whose controller works in steps, the latter alone counts, of less than others. A
    delay or a lag of less than half a sample is that of such steps, or of clocks.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Without a discrepancy.
    shares : Shares
        Of all names.
    name : str
        One of them.

    Returns
    -------
    trifle : bool
        If so, it is not worth a name.

    """
    best, explained = shares.best, shares.explained >= EXPLAINED
    of_robot = EFFECTS[name].port == 'robot'
    surely = shares.sure(name) >= SURELY_MOST or (
        not of_robot and shares.explained >= OF_LITTLE)
    lawful = explained and shares.is_constant(name)
    of_steps = _is_of_steps(recordings, best, name)
    if lawful and surely and not of_steps:
        return False
    without = fit_without(recordings, best.model, (name,))
    carried = weighed(recordings, without.model)
    if not explained:
        return not material(carried, without.model)
    least = _TINY if of_robot and not of_steps else 1.0
    if (of_steps or not surely) and not material(carried, without.model, least):
        return True
    if lawful:
        return False
    gain = without.cost - best.cost
    return gain <= best.residual_count and not material(carried, without.model, _SMALL)


def _is_of_steps(recordings: Recordings, best: Fit, name: str) -> bool:
    """Return whether a delay or a lag is shorter than steps of a controller may cause."""
    values = best.model.parameters_of(name)
    delay = getattr(values, EFFECTS[name].sampled_delay, np.inf)
    return bool(delay < _OF_STEPS * max((one.observed.h for one in recordings), default=0.0))


def without_unconfirmed_trifles(recordings: Recordings, base: Fit, best: Fit) -> Fit | None:
    """
    Fit without all laws if together they explain a trifle that nothing confirms as a law.

    A law down to the noise is one however little it explains. Where residuals as small as the
    noise are correlated, the noise is that of rounded positions, say, and hides what else is
    missing: then the laws are curves through one of the small imperfections of every rig. So are
    they in a single stroke.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Those with a discrepancy only matter as a single stroke.
    base, best : Fit
        Recalibrated, and with effects.

    Returns
    -------
    rest : Fit or None
        `base`, or with the zeros alone if it leaves more; None if the laws are worth their names.

    """
    laws = [name for name in best.model.effects if name not in ZEROS]
    if not laws or not is_single_stroke(recordings) and not _is_correlated(recordings, best):
        return None
    least = least_worth_a_name(recordings)
    if not material(weighed(recordings, base.model), base.model, least):
        return base
    rest = fit_without(recordings, best.model, laws)
    return None if material(weighed(recordings, rest.model), rest.model, least) else rest


def _is_correlated(recordings: Recordings, best: Fit) -> bool:
    """Return whether neighbouring residuals, of the size of the noise, tell much the same."""
    return not has_discrepancy(recordings) and max(
        correlation_time(part) for one in recordings
        for part in one.split(residuals(one, best.model))) >= _CORRELATED
