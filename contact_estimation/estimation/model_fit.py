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
from math import nan
from typing import NamedTuple

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

    The edges of a contact are left out: there the dynamics of the force sensor dominate.

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

    """

    def __init__(self, sample_rate: float) -> None:
        self._T = 1.0 / sample_rate
        self._block = max(_LEAST_ROWS // 3, round(_JUDGED_EVERY_S / self._T))
        self._blocks = max(3, round(_WINDOW_S / self._T / self._block))
        self._hold = max(1, round(_LEAVING_S / self._T))
        self._whole = (self._block + self._hold) * _COLUMNS
        self.reset()

    def reset(self) -> None:
        """Forget the window and all mismatches."""
        self.now = self.worst = UNKNOWN
        self.count = 0
        self.restart()

    def restart(self) -> None:
        """Start a new window, as after a change of parameters; the last judgement stays."""
        self._past: deque[Array] = deque(maxlen=self._blocks)
        self._pending: list[float] = []  # one row after the other
        self._fresh = 0  # of the last pending rows: dropped where the contact ends with them
        self._contact_s = self._free_s = self._t = 0.0
        self._bad = 0

    def take(
        self, sample: ContactSample, dt: float, touching: bool, noise_variance: float,
        row: Row | None, gain: NoiseGain, estimator: OnlineEstimator, position_noise: float,
    ) -> float:
        """
        Take the next sample.

        Parameters
        ----------
        sample : ContactSample
            The sample.
        dt, touching, noise_variance, row, gain
            As of `Conditioner.take`.
        estimator : OnlineEstimator
            Whose model is judged.
        position_noise : float
            Standard deviation of the position [m].

        Returns
        -------
        ratio : float
            `ModelFit.ratio` after it.

        """
        if not touching:
            self._leave(dt)
        elif self._collect(dt, row, sample, gain):
            self._judge(sample[0], noise_variance, estimator, position_noise)
        return self.now[0]

    def _leave(self, dt: float) -> None:
        """Note a sample out of contact."""
        self._contact_s = 0.0
        if not self._t:
            return
        if self._fresh:
            del self._pending[-self._fresh * _COLUMNS:]
            self._fresh = 0
        self._t += dt
        self._free_s += dt
        if self._free_s > _NEW_WALL_S:
            self.restart()

    def _collect(self, dt: float, row: Row | None, sample: ContactSample, gain: NoiseGain) -> bool:
        """Collect a sample in contact; return whether it completes a block."""
        self._free_s = 0.0
        self._t = t = self._t + dt
        if self._contact_s <= _SETTLING_S:
            self._contact_s += dt
        if self._contact_s <= _SETTLING_S or not row:
            return False
        pending = self._pending
        pending += (t, *row, sample[3], sample[1], sample[2], *gain)
        if self._fresh < self._hold:
            self._fresh += 1
            return False
        return len(pending) >= self._whole

    def _judge(
        self, stamp_ns: int, noise_variance: float, estimator: OnlineEstimator,
        position_noise: float,
    ) -> None:
        count = self._block * _COLUMNS
        # One column after the other: the arithmetic runs along them.
        table = np.array(self._pending[:count]).reshape(-1, _COLUMNS).T.copy()
        del self._pending[:count]
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
