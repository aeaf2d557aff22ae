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

"""Whether the joint states are stamped late, which looks like a delay of the command."""

from __future__ import annotations

from dataclasses import replace
from typing import Callable, Sequence

import numpy as np
from scipy.optimize import minimize_scalar

from .criteria import leaves_noise
from .fitting import Fit, fit
from .model_uncertainty import discounted
from .selection import Selection
from ..observe.model import Model
from ..observe.prepared_recording import prepare, PreparedRecording, Recordings
from ..observe.signals import Recording

Select = Callable[[Sequence[Recording]], tuple[Recordings, Selection]]

_DELAY = 'command_delay'
_SCANNED = (0.0015, 0.003, 0.005, 0.008, 0.012, 0.018, 0.027)  # [s]
_TRIED = (1.0, 1.2)  # times the delay: what bends beside it makes it too short
_PROMISING, _WITH_DELAY = 0.75, 1.4  # most of the misfit of the effects, for stamps to be tried
_LEFT = 0.25  # most of it that late stamps may leave
_DAMPED = 0.05  # of the damping without a shift
_LEAST = 0.003  # [s]: less is that of a sensor's filter
_OF_PERIOD = 0.9  # of a sample: less is the course of the signals between samples


class JointClock:
    """
    Comparison of joint states as stamped with ones stamped earlier.

    A robot that moves late meets the wall where the wall is. One whose stamps are late meets it
    before it is there, by its speed times the lateness. A wall that a force drives moves with it.

    Parameters
    ----------
    raw : sequence of Recording
        As recorded.
    recordings : sequence of PreparedRecording
        The same, prepared, without a discrepancy.
    base, best : Model
        Recalibrated, and with the effects that were selected.
    hold : int
        Which part of each recording is held out, as for `prepare`.

    """

    def __init__(
        self, raw: Sequence[Recording], recordings: Recordings, base: Model, best: Model,
        hold: int,
    ) -> None:
        self._raw, self._recordings, self._base, self._hold = raw, recordings, base, hold
        self._delay = best.values[best.place(_DELAY).start] if _DELAY in best.effects else 0.0
        self._rest = best.without(_DELAY) if self._delay else best
        found = fit(recordings, best)
        self._explained = leaves_noise(found)
        self._misfit = _misfit(found)

    def lateness(self, select: Select) -> float:
        """
        Return by how much the joint states are stamped later than the other topics.

        Parameters
        ----------
        select : callable
            Selects the effects of other recordings.

        Returns
        -------
        late : float
            [s]; 0 unless it is that of a sample or more, or a filter, and leaves less than
            a quarter of what the effects leave, and a wall with damping: a shift that takes the
            place of it is none.

        """
        if self._explained:
            return 0.0
        period = max(float(np.median(np.diff(one.signals.joint_t))) for one in self._raw)
        for late in self._tried():
            if late < max(_LEAST, _OF_PERIOD * period):
                continue
            earlier, selection = select(self._earlier(late))
            found = fit(earlier, selection.best.model)
            damped = _damping(found.model) >= _DAMPED * _damping(self._base)
            if damped and _misfit(found) < _LEFT * self._misfit:
                return late
        return 0.0

    def _tried(self) -> list[float]:
        """List the latenesses that a selection may confirm, the likeliest first."""
        of_delay = [share * self._delay for share in _TRIED if self._delay]
        scans = []
        for late in _SCANNED:
            prepared = self._prepared(late)
            scans += [(_left(prepared, model), late, model)
                      for model in dict.fromkeys((self._base, self._rest))]
        least, late, model = min(scans, key=lambda scan: scan[:2])
        if least > (_WITH_DELAY if self._delay else _PROMISING) * self._misfit:
            return []
        nearby = minimize_scalar(lambda by: _left(self._prepared(by), model), method='bounded',
                                 bounds=(0.7 * late, 1.4 * late), options={'maxiter': 8})
        return [float(nearby.x), *of_delay]

    def _prepared(self, late: float) -> Recordings:
        return [self._discounted_as(before, prepare(one, self._base, hold=self._hold))
                for before, one in zip(self._recordings, self._earlier(late))]

    def _discounted_as(
        self, before: PreparedRecording, earlier: PreparedRecording
    ) -> PreparedRecording:
        """Discount what is uncertain as before the shift, which moves it little."""
        if earlier.block_count != before.block_count:
            return discounted(earlier, self._base)
        return replace(earlier, discount=before.discount)

    def _earlier(self, by: float) -> list[Recording]:
        return [replace(one, signals=one.signals._replace(joint_t=one.signals.joint_t - by))
                for one in self._raw]


def _left(recordings: Recordings, model: Model) -> float:
    """Return the misfit of effects that are not selected again."""
    nominal = Model.of(model.nominal).values  # what is late bends the damping
    start = model.at([*nominal, *model.values[len(nominal):]])
    return _misfit(fit(recordings, start, steps=8))


def _damping(model: Model) -> float:
    return model.laws().contact.damping


def _misfit(found: Fit) -> float:
    """Return the cost beyond noise."""
    return found.cost - found.residual_count
