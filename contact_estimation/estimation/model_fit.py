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

"""Whether the estimator's model fits the last two seconds of contact."""

from __future__ import annotations

from collections import deque
from itertools import chain
from math import nan
from typing import NamedTuple, Sequence

import numpy as np

from .residual_smells import smell_of
from .residual_structure import Array, fit, Window
from ..estimators.estimator import OnlineEstimator
from ..signals.contact_sample import ContactSample
from ..signals.relations import NoiseGain, Row

_WINDOW_S = 2.0
_JUDGED_EVERY_S = 0.4
_LEAST_ROWS = 60  # of a judged window
_SETTLING_S = 0.05  # after touch-down: the sensor's lag smears the step of the force
_LEAVING_S = 0.02  # before release: with a lag the force outlasts the contact
_NEW_WALL_S = 0.5  # free for so long, the next contact may be with another wall
_TOLD = 2.0  # ratio from which a judgement is bad
_ALL_CLEAR = 1.5
_CONSECUTIVE = 2  # bad judgements before a mismatch is reported
_ROW, _RAW, _GAINS, _COLUMNS = slice(1, 6), slice(6, 9), slice(9, 11), 11

Collected = tuple[float, Row, ContactSample, NoiseGain]
"""Time [s], filtered row, sample, and how noise enters the row."""


class ModelFit(NamedTuple):
    """
    Judgement of one window.

    Attributes
    ----------
    ratio : float
        Rms of noise and structure of the residual over that of the noise; NaN while unknown.
    text : str
        What the residual depends on, and what to do; '' while the model fits.
    stamp_ns : int
        Stamp of the sample that completed the window [ns].

    """

    ratio: float
    text: str
    stamp_ns: int


UNKNOWN = ModelFit(nan, '', 0)


class ModelFitMonitor:
    """
    Compare the residual of the estimator's model with the noise, over 2 s of contact.

    The edges of a contact are left out: there the dynamics of the force sensor dominate. The
    pipeline collects the rows between: `judge` is due when as many as `due` are pending.

    Parameters
    ----------
    sample_rate : float
        Nominal [Hz].

    Attributes
    ----------
    now : ModelFit
        The last judgement.
    worst : ModelFit
        The worst mismatch reported since the start or `reset`; UNKNOWN without one.
    count : int
        Number of mismatches reported.
    t : float
        Time since the window began [s].
    settled : bool
        Whether the present contact is old enough for its rows to be collected.
    pending : list of Collected
        Rows of contacts that no judgement has used.
    due : int
        Number of them at which the next judgement is due: the last ones may be those before a
        release.

    """

    def __init__(self, sample_rate: float) -> None:
        self._T = 1.0 / sample_rate
        self._block = max(_LEAST_ROWS // 3, round(_JUDGED_EVERY_S / self._T))
        self._blocks = max(3, round(_WINDOW_S / self._T / self._block))
        self._hold = max(1, round(_LEAVING_S / self._T))
        self.reset()

    def reset(self) -> None:
        """Forget the window and all mismatches."""
        self.now = self.worst = UNKNOWN
        self.count = 0
        self.restart()

    def restart(self) -> None:
        """Start a new window, as after a change of parameters; the last judgement stays."""
        self._past: deque[Array] = deque(maxlen=self._blocks)
        self.pending: list[Collected] = []
        self.settled = False
        self._contact_s = self._free_s = self.t = 0.0
        self._bad = 0
        self._begin_contact(0)

    def settle(self, dt: float) -> bool:
        """
        Note a sample in contact while it is not `settled`; return whether it is now.

        Parameters
        ----------
        dt : float
            Time since the sample before [s].

        """
        self._free_s = 0.0
        self._contact_s += dt
        self.settled = self._contact_s > _SETTLING_S
        return self.settled

    def leave(self, dt: float) -> None:
        """
        Note a sample out of contact.

        Parameters
        ----------
        dt : float
            Time since the sample before [s].

        """
        self._contact_s, self.settled = 0.0, False
        if not self.t:
            return
        fresh = min(self._hold, len(self.pending) - self._begin)
        if fresh:
            del self.pending[-fresh:]
            self._begin_contact(len(self.pending))
        self.t += dt
        self._free_s += dt
        if self._free_s > _NEW_WALL_S:
            self.restart()

    def _begin_contact(self, pending: int) -> None:
        """Note how many of the pending rows are those of contacts before."""
        self._begin = pending
        self.due = max(self._block, pending + 1) + self._hold

    def judge(
        self, noise_variance: float, estimator: OnlineEstimator, position_noise: float
    ) -> None:
        """
        Judge the window that ends with the oldest block of the pending rows.

        Parameters
        ----------
        noise_variance : float
            Of the force [N^2].
        estimator : OnlineEstimator
            Whose model is judged.
        position_noise : float
            Standard deviation of the position [m].

        """
        stamp_ns = self.pending[-1][2][0]
        # One column after the other: the arithmetic runs along them.
        table = _table_of(self.pending[:self._block])
        del self.pending[:self._block]
        self._begin_contact(self._begin - self._block)
        self._past.append(table)
        if len(self._past) * self._block < _LEAST_ROWS:
            return
        window = self._window(estimator, position_noise)
        residual = fit(window, noise_variance, position_noise, self._T)
        self._bad = self._bad + 1 if residual.ratio >= _TOLD else 0
        goes_on = bool(self.now.text) and residual.ratio >= _ALL_CLEAR
        if self._bad < _CONSECUTIVE and not goes_on:
            self.now = ModelFit(residual.ratio, '', stamp_ns)
            return
        self.count += not self.now.text
        text = f'residual {residual.ratio:.2g} x noise, {smell_of(window, residual)}'
        self.now = ModelFit(residual.ratio, f'{text} run diagnose', stamp_ns)
        if not self.worst.ratio >= residual.ratio:
            self.worst = self.now

    def _window(self, estimator: OnlineEstimator, position_noise: float) -> Window:
        """Return the window with the columns of the estimator."""
        table = np.concatenate(self._past, axis=1)
        rows = table[_ROW].T
        return Window(
            table[0], rows, estimator.columns_of(rows), table[_RAW].T, table[_GAINS].T,
            max(estimator.location_std or 0.0, position_noise),
        )


def _table_of(collected: Sequence[Collected]) -> Array:
    """Return the columns of rows: time, row, force, position and rate, gains."""
    count = len(collected)
    t, rows, samples, gains = zip(*collected)
    _, x, v, force = zip(*samples)
    table = np.empty((_COLUMNS, count))
    table[0] = t
    table[_ROW] = np.fromiter(chain.from_iterable(rows), float, 5 * count).reshape(count, 5).T
    table[_RAW] = force, x, v
    table[_GAINS] = np.fromiter(chain.from_iterable(gains), float, 2 * count).reshape(count, 2).T
    return table
