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

"""An estimator updated only by informative data, with systematic errors in its deviations."""

from __future__ import annotations

from itertools import repeat
from math import isfinite
from typing import Sequence

from .parameters import EstimationParameters
from ..estimators import ESTIMATORS
from ..estimators.equation_noise import EquationNoise
from ..estimators.estimator import (
    EstimateStatus,
    Frozen,
    OnlineEstimator,
    ParameterEstimate,
    TimedRow,
)
from ..estimators.excitation_monitor import ExcitationMonitor
from ..signals.conditioning import Conditioned, stretches
from ..signals.relations import NoiseGain, Row

_FROZEN_REASONS = {
    Frozen(False, False): '',
    Frozen(False, True): 'damping frozen: weak excitation',
    Frozen(True, False): 'stiffness frozen: weak excitation',
    Frozen(True, True): 'weak excitation',
}
_WAITING = 'waiting for consecutive samples'
_NOT_PREDICTED = 'predicted force within the noise'
_NOT_FINITE = 'estimate was not finite; reset to the initial values'
State = tuple[ParameterEstimate, EstimateStatus, str]


class SupervisedEstimator:
    """
    An estimator, the monitor of its excitation and the noise of its equation.

    The monitor decides at fixed counts of rows which parameters are updated. Rows are collected
    in between, so that the estimates do not depend on how the samples are cut into runs.

    Parameters
    ----------
    parameters : EstimationParameters
        All parameters.

    Attributes
    ----------
    estimator : OnlineEstimator
        The estimator.
    monitor : ExcitationMonitor
        Its excitation monitor.

    """

    def __init__(self, parameters: EstimationParameters) -> None:
        self._p = parameters
        self.estimator = self._new_estimator()
        self._noise = EquationNoise(parameters.contact.force_noise**2)
        self._new_monitor()
        self._predict()

    def _new_estimator(self) -> OnlineEstimator:
        p = self._p
        tuning = getattr(p.tuning, p.estimator)
        return ESTIMATORS[p.estimator](tuning, p.environment, 1.0 / p.sample_rate)

    def _new_monitor(self) -> None:
        self.monitor = ExcitationMonitor(self._p.excitation, 1.0 / self._p.sample_rate)
        self._start_collecting()

    def configure(self, parameters: EstimationParameters) -> None:
        """
        Set new parameters while running; a new estimator starts from the present K_hat and B_hat.

        Parameters
        ----------
        parameters : EstimationParameters
            All parameters.

        """
        old, self._p = self._p, parameters
        rate_changed = parameters.sample_rate != old.sample_rate
        self._pass_to_monitor()
        if rate_changed or parameters.estimator != old.estimator:
            self._switch()
        if parameters.environment != old.environment or parameters.tuning != old.tuning:
            self.estimator.environment = parameters.environment
            self.estimator.configure(getattr(parameters.tuning, parameters.estimator))
        if rate_changed:
            self._new_monitor()
        elif parameters.excitation != old.excitation:
            self.monitor.configure(parameters.excitation)
        self._start_collecting()

    def _switch(self) -> None:
        stiffness, damping = self.estimator.stiffness, self.estimator.damping
        self.estimator = self._new_estimator()
        self.estimator.start_from(*self.estimator.within_limits(stiffness, damping))
        self._noise.forget_updates()
        self._predict()

    def reset(self) -> None:
        """Reset the estimate to its initial values, and excitation and noise with it."""
        self.estimator.reset()
        self.monitor.reset()
        self._start_collecting()
        self._noise = EquationNoise(self._p.contact.force_noise**2)
        self._predict()

    def process(self, conditioned: Conditioned) -> list[State]:
        """
        Update the estimate with every sample that has a row.

        Parameters
        ----------
        conditioned : Conditioned
            Of a run of samples.

        Returns
        -------
        states : list of (ParameterEstimate, EstimateStatus, str)
            Estimate, status and reason after each sample.

        """
        dts, _, contact, variances, rows, gains, _ = conditioned
        if None not in rows:
            return self._update(dts, rows, gains, variances[0])
        states: list[State] = []
        for begin, end in stretches([row is not None for row in rows]):
            if rows[begin] is None:
                states += self._keep(contact[begin:end])
            else:
                states += self._update(
                    dts[begin:end], rows[begin:end], gains[begin:end], variances[begin]
                )
        return states

    def _keep(self, contact: Sequence[bool]) -> list[State]:
        """Keep the estimate: out of contact, or while consecutive samples are lacking."""
        now = self._current()
        free: State = now, EstimateStatus.FREE, ''
        waiting: State = now, EstimateStatus.FROZEN, _WAITING
        return [waiting if touching else free for touching in contact]

    def _update(
        self, dts: Sequence[float], rows: Sequence[Row | None], gains: Sequence[NoiseGain],
        force_variance: float,
    ) -> list[State]:
        longest = 2.0 / self._p.sample_rate  # never integrate over a gap
        timed: list[TimedRow] = [
            (dt if dt < longest else longest, row) for dt, row in zip(dts, rows) if row
        ]
        states: list[State] = []
        begin = 0
        while begin < len(timed):
            part = timed[begin:begin + self._until_judgement]
            self._rows += part
            self._gains += gains[begin:begin + len(part)]
            states += self._update_part(part, max(force_variance, self._noise.variance))
            self._until_judgement -= len(part)
            if self._until_judgement == 0:
                self._judge(force_variance)
            begin += len(part)
        return states

    def _update_part(self, part: list[TimedRow], variance: float) -> list[State]:
        """Update with rows between two judgements, where the predicted force is above noise."""
        frozen = self.monitor.frozen
        reason = _FROZEN_REASONS[frozen]
        if frozen.stiffness and frozen.damping:
            return [(self._current(), EstimateStatus.FROZEN, reason)] * len(part)
        K, B, floor = self._prediction
        predicted = [K * row[1] + B * row[2] > floor for _, row in part]
        states: list[State] = []
        for begin, end in stretches(predicted):
            if not predicted[begin]:
                waits: State = self._current(), EstimateStatus.FROZEN, _NOT_PREDICTED
                states += [waits] * (end - begin)
                continue
            self._noise.note_update(frozen)
            estimates = self.estimator.update(part[begin:end], variance, frozen)
            widened = map(self._noise.widen, estimates)
            states += zip(widened, repeat(EstimateStatus.ESTIMATING), repeat(reason))
        return self._checked(states)

    def _current(self) -> ParameterEstimate:
        return self._noise.widen(self.estimator.current())

    def _checked(self, states: list[State]) -> list[State]:
        """Reset the estimator where its estimate is not finite."""
        now = states[-1][0]
        if isfinite(now.stiffness) and isfinite(now.damping):
            return states
        self.estimator.reset()
        return [(self._current(), EstimateStatus.FROZEN, _NOT_FINITE)] * len(states)

    def _judge(self, force_variance: float) -> None:
        """Let the monitor judge which parameters the collected rows excite."""
        estimator, environment = self.estimator, self._p.environment
        self._pass_to_monitor()
        self._noise.judge(
            self.monitor.window(), force_variance, self._p.contact.position_noise, estimator
        )
        self.monitor.judge(
            self._noise.variance,
            max(estimator.stiffness, 0.1 * environment.initial_stiffness),
            max(estimator.damping, environment.initial_damping, 1e-3),
            estimator.location_std,
        )
        self._start_collecting()
        self._predict()

    def _pass_to_monitor(self) -> None:
        """Pass the collected rows to the monitor, linearised about the last judged estimate."""
        linear = self._linear
        self.monitor.add([linear(row) if linear else row for _, row in self._rows], self._gains)

    def _start_collecting(self) -> None:
        self._rows: list[TimedRow] = []
        self._gains: list[NoiseGain] = []
        self._until_judgement = self.monitor.until_judgement

    def _predict(self) -> None:
        """Store prediction and linearisation for the rows until the next judgement."""
        self._linear = self.estimator.linearisation()
        if self.estimator.estimates_location:
            self._prediction = 0.0, 0.0, -1.0  # no prediction before the location is known
            return
        K, B = self.estimator.stiffness, self.estimator.damping
        self._prediction = K, B, 3.0 * K * self._p.contact.position_noise
