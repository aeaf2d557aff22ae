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
The pull at the end of contacts: the mark of adhesion.

A soft adhesive thing is also curved, slow and seldom touched more than once, so that no law
predicts much of the misfit. But nothing else holds the tool back while it leaves.
"""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from .fitting import Fit
from ..observe.episodes import episodes
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings
from ...physics import EFFECTS

Array = NDArray[np.float64]

_ADHESION = 'adhesion'
_SMOOTHED = 5  # samples, of the force
_LEAST, _NOISE = 0.05, 10.0  # of the greatest force; standard deviations of the smoothed force
_ELSEWHERE = 0.3  # of the pull: most of any force of its sign before, and of the other after
_ALIKE = 0.6  # deviation over the mean
_ONCE = 0.3  # the same, of a single contact


class PullOffs(NamedTuple):
    """
    Adhesion as the end of each contact tells it.

    Attributes
    ----------
    sizes : ndarray, shape (C,)
        Greatest pull while the tool leaves, less the force before the contact [N]; 0 where the
        same happens before contact, or the force swings.
    least : float
        Less is a trifle [N].

    """

    sizes: Array
    least: float

    @property
    def spread(self) -> float:
        """Return the standard deviation of the sizes over their mean."""
        if len(self.sizes) < 2:
            return _ONCE
        return float(np.std(self.sizes, ddof=1) / abs(np.mean(self.sizes)))

    @property
    def are_clear(self) -> bool:
        """Whether the wall pulls at the end of every contact, and alike."""
        return bool(len(self.sizes) and np.min(self.sizes) > self.least and self.spread < _ALIKE)

    @property
    def words(self) -> str:
        """Say what was seen."""
        several = f' +- {np.std(self.sizes, ddof=1):.2g}' if len(self.sizes) > 1 else ''
        times = f'each of {len(self.sizes)} contacts' if len(self.sizes) > 1 else 'the contact'
        return f'the wall pulls by {np.mean(self.sizes):.3g}{several} N at the end of {times}'


def pull_offs(recordings: Recordings, model: Model) -> PullOffs:
    """
    Measure the pull at the end of each contact.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Of a wall that can be left.
    model : Model
        Defines where the surface is.

    Returns
    -------
    pulls : PullOffs
        Of all recordings.

    """
    sizes = [size for one in recordings for size in _sizes(one, model)]
    greatest = max(float(np.max(-one.observed.force)) for one in recordings)
    noise = max(one.force_noise for one in recordings) / np.sqrt(_SMOOTHED)
    return PullOffs(np.array(sizes), max(_LEAST * greatest, _NOISE * noise))


def is_pulled_off(recordings: Recordings, model: Model, name: str) -> bool:
    """
    Return whether an effect is an adhesion that the end of each contact tells.

    Parameters
    ----------
    recordings, model
        As of `pull_offs`.
    name : str
        Of the effect.

    Returns
    -------
    pulled : bool
        If so, no other part need tell it.

    """
    return (_sticks(name) and model.nominal.environment.unilateral
            and pull_offs(recordings, model).are_clear)


def adhesion_at_release(
    recordings: Recordings, present: Fit, found: Sequence[Fit]
) -> tuple[Fit, PullOffs] | None:
    """
    Return the adhesion that the ends of contacts tell where no law predicts much of the misfit.

    Parameters
    ----------
    recordings, present, found
        As of `law_by_mark`.

    Returns
    -------
    adhesion : (Fit, PullOffs) or None
        None in a permanently attached wall, beside an adhesion, and unless every contact ends with
        a pull.

    """
    model = present.model
    sticky = [one for one in found if _sticks(one.model.effects[-1])]
    if not model.nominal.environment.unilateral or any(map(_sticks, model.effects)) or not sticky:
        return None
    pulls = pull_offs(recordings, model)
    return (sticky[0], pulls) if pulls.are_clear else None


def _sticks(name: str) -> bool:
    return EFFECTS[name].family == _ADHESION


def _sizes(recording: PreparedRecording, model: Model) -> list[float]:
    o, found = recording.observed, episodes(model, recording.observed)
    force = uniform_filter1d(o.force, _SMOOTHED)
    middles = [(stop + first) // 2 for (_, stop), (first, _) in zip(found, found[1:])]
    sizes = []
    for (first, stop), begin, end in zip(found, [0, *middles], [*middles, len(force)]):
        deepest = first + int(np.argmax(o.x[first:stop]))
        before, leaving, after = force[begin:first], force[deepest:end], force[stop:end]
        if max(len(before), len(after)) < 3 * _SMOOTHED or len(after) < _SMOOTHED:
            continue
        # A recording may begin in contact.
        free = before[:len(before) // 2] if len(before) >= 3 * _SMOOTHED else (
            after[len(after) // 2:])
        rest = float(np.median(free))
        top = int(np.argmax(leaving))
        pull = float(leaving[top]) - rest
        # Nearer than where it lets go, a wall may also draw the tool in.
        farther = before[o.x[begin:first] < o.x[deepest + top]]
        swings = float(np.max(farther, initial=rest)) - rest, rest - float(np.min(leaving[top:]))
        sizes.append(pull if max(swings) < _ELSEWHERE * pull else 0.0)
    return sizes
