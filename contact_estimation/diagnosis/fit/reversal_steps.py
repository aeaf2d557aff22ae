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
Steps of the force at the reversals of a motion: the mark of friction.

What else pushes a joint, such as the other joints of its arm, may be many times the friction, so
that no law predicts much of the misfit. But it changes little while the motion turns, where
friction changes its sign: each reversal measures it once more.
"""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .discrepancy import least_material
from .fitting import Fit
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings
from ..observe.residuals import force_residual
from ...physics import EFFECTS

Array = NDArray[np.float64]

_FRICTION = 'friction'
_SLOW = 0.15  # of the rms speed: the motion turns
_WIDER, _LEAST_SAMPLES = 2, 4  # times the samples of the turn, and their least number on each side
_LEAST_REVERSALS, _SURE, _ALIKE = 5, 6.0, 0.6  # standard errors of the mean; deviation over it
_LARGE = 0.25  # of the misfit, rms


class ReversalSteps(NamedTuple):
    """
    Friction as each reversal tells it.

    Attributes
    ----------
    sizes : ndarray, shape (R,)
        Half of each step of the force, positive against the motion [N].
    misfit : float
        Root mean square of the whole residual [N].

    """

    sizes: Array
    misfit: float

    @property
    def spread(self) -> float:
        """Return the standard deviation of the sizes over their mean."""
        return float(np.std(self.sizes, ddof=1) / abs(np.mean(self.sizes)))

    @property
    def words(self) -> str:
        """Say what was seen."""
        return (f'the force steps by {2.0 * np.mean(self.sizes):.3g} +- '
                f'{2.0 * np.std(self.sizes, ddof=1):.2g} N at each of {len(self.sizes)} reversals')

    @property
    def are_friction(self) -> bool:
        """Whether they resist the motion, are alike beyond doubt and not small."""
        count = len(self.sizes)
        if count < _LEAST_REVERSALS or np.mean(self.sizes) <= _LARGE * self.misfit:
            return False
        return self.spread <= min(_ALIKE, np.sqrt(count) / _SURE)


def reversal_steps(recordings: Recordings, model: Model) -> ReversalSteps:
    """
    Measure the steps of the residual force where the motion turns.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Of an attached wall.
    model : Model
        Without friction.

    Returns
    -------
    steps : ReversalSteps
        Of all recordings; those too near to one another are left out.

    """
    residuals = [force_residual(one, model) for one in recordings]
    sizes = [_sizes(one, left) for one, left in zip(recordings, residuals)]
    return ReversalSteps(np.concatenate(sizes), float(np.std(np.concatenate(residuals))))


def friction_at_reversals(
    recordings: Recordings, present: Fit, found: Sequence[Fit]
) -> tuple[Fit, ReversalSteps] | None:
    """
    Return the friction that the reversals tell where no law predicts much of the misfit.

    Parameters
    ----------
    recordings, present, found
        As of `law_by_mark`.

    Returns
    -------
    friction : (Fit, ReversalSteps) or None
        The best law of friction that jumps, else the best; None in a wall that can be left, beside
        a friction, and unless the steps at the reversals are alike and no trifle.

    """
    model = present.model
    if model.nominal.environment.unilateral or _rubs(model):
        return None
    friction = [one for one in found if _rubs(one.model)]
    if not friction:
        return None
    steps = reversal_steps(recordings, model)
    trifle = max(least_material(one) for one in recordings)
    if not steps.are_friction or np.mean(steps.sizes) < trifle:
        return None
    sharp = [one for one in friction if getattr(EFFECTS[one.model.effects[-1]], 'jumps', False)]
    return (sharp or friction)[0], steps


def _rubs(model: Model) -> bool:
    return any(EFFECTS[name].family == _FRICTION for name in model.effects)


def _sizes(recording: PreparedRecording, left: Array) -> Array:
    """Fit a line and a step to the residual around each reversal."""
    v = recording.observed.v
    slow = _SLOW * float(np.sqrt(np.mean(v**2)))
    moving = np.flatnonzero(np.abs(v) > slow)
    turns = np.flatnonzero(np.diff(np.sign(v[moving])) != 0)
    before, after = moving[turns], moving[turns + 1]
    starts, stops = np.append(0, after[:-1]), np.append(before[1:], len(v) - 1)
    sizes = []
    for start, last, first, stop in zip(starts, before, after, stops):
        reach = _WIDER * (first - last) + _LEAST_SAMPLES
        rows = (np.arange(max(start, last - reach), last),
                np.arange(first, min(stop, first + reach)))
        if min(map(len, rows)) >= _LEAST_SAMPLES:
            sizes.append(-float(np.sign(v[first])) * _half_step(rows, left))
    return np.array(sizes)


def _half_step(rows: Sequence[NDArray[np.int_]], left: Array) -> float:
    """Return half the step between two stretches that have one slope."""
    place = np.concatenate(rows)
    side = np.repeat([-1.0, 1.0], [len(part) for part in rows])
    columns = np.column_stack([side, np.ones(len(place)), place - float(np.mean(place))])
    return float(np.linalg.lstsq(columns, left[place], rcond=None)[0][0])
