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

from collections import deque
from itertools import repeat
from math import isfinite
from typing import Sequence

from .parameters import EstimationParameters
from .robot_compliance import of_the_wall
from .wall_tracking import Change, WallTracker
from ..estimators import ESTIMATORS
from ..estimators.equation_noise import EquationNoise
from ..estimators.estimator import (
    EstimateStatus,
    Frozen,
    OnlineEstimator,
    ParameterEstimate,
    TimedRow,
)
from ..estimators.excitation_monitor import ExcitationMonitor, RECENT
from ..estimators.systematic_errors import SystematicErrors
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
_EARLY_BLOCKS = 5  # during which errors are judged more often
_JUDGED_TOGETHER = 2  # blocks, later
_LEARNT_AGAIN = 250  # rows after a restart
_NEW_CONTACT_S = 0.05  # out of contact, after which a contact is a new one
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
        self._errors = SystematicErrors(parameters.synchronisation.timing_std)
        self._new_tracker()
        self._new_monitor()
        self._predict()

    def _new_estimator(self) -> OnlineEstimator:
        p = self._p
        tuning = getattr(p.tuning, p.estimator)
        return ESTIMATORS[p.estimator](tuning, p.environment, 1.0 / p.sample_rate)

    def _new_tracker(self) -> None:
        p = self._p
        self._tracker = WallTracker(
            p.tracking, p.environment.location_std, p.contact.position_noise,
            p.synchronisation.timing_std)
        self._free_s = 0.0
        self._judged = False  # in this contact
        self._past: deque[TimedRow] = deque(maxlen=_LEARNT_AGAIN)  # rows of this wall

    def take_location(self, std: float) -> None:
        """Use another location of the surface, with its standard deviation [m]."""
        self._new_tracker()
        self._tracker.doubt_location(std)

    def _new_monitor(self) -> None:
        self.monitor = ExcitationMonitor(self._p.excitation, 1.0 / self._p.sample_rate)
        self._judged_blocks = 0
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
        self._errors.timing_std = parameters.synchronisation.timing_std
        rate_changed = parameters.sample_rate != old.sample_rate
        self._pass_to_monitor()
        if rate_changed or parameters.estimator != old.estimator:
            self._switch()
        if parameters.environment != old.environment or parameters.tuning != old.tuning:
            self.estimator.environment = parameters.environment
            self.estimator.configure(getattr(parameters.tuning, parameters.estimator))
        if parameters.environment.location != old.environment.location:
            self._new_tracker()
        self._tracker.configure(
            parameters.tracking, parameters.environment.location_std,
            parameters.contact.position_noise, parameters.synchronisation.timing_std)
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
        self._errors = SystematicErrors(self._p.synchronisation.timing_std)
        self._predict()

    def reset(self) -> None:
        """Reset the estimate to its initial values, and excitation and noise with it."""
        self.estimator.reset()
        self.monitor.reset()
        self._start_collecting()
        self._noise = EquationNoise(self._p.contact.force_noise**2)
        self._errors = SystematicErrors(self._p.synchronisation.timing_std)
        self._new_tracker()
        self._predict()

    @property
    def hindrance(self) -> str:
        """Return what hinders the estimator on the present contact; '' for nothing."""
        return self.estimator.hindrance(self.monitor.window().products)

    @property
    def shift(self) -> float:
        """Estimated location less the configured one [m], the same for every estimator."""
        return self._tracker.shift

    @property
    def location_unchecked(self) -> bool:
        """Whether the present contact has not shown where its surface is."""
        return self._tracker.location_unchecked

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
                states += self._keep(dts[begin:end], contact[begin:end])
            else:
                states += self._update(
                    dts[begin:end], rows[begin:end], gains[begin:end], variances[begin]
                )
        return states

    def _keep(self, dts: Sequence[float], contact: Sequence[bool]) -> list[State]:
        """Keep the estimate: out of contact, or while consecutive samples are lacking."""
        self._free_s += sum(dt for dt, touching in zip(dts, contact) if not touching)
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
        if self._free_s >= _NEW_CONTACT_S and self._judged:
            self._touch_down()
        self._free_s = 0.0
        states: list[State] = []
        begin = 0
        while begin < len(timed):
            part = timed[begin:begin + self._until_judgement]
            self._past += part
            if self._tracker.shift:
                part = _shifted(part, self._tracker.shift)
            self._rows += part
            self._gains += gains[begin:begin + len(part)]
            states += self._update_part(part, max(force_variance, self._noise.variance))
            self._until_judgement -= len(part)
            if self._until_judgement == 0:
                self._judge(force_variance)
            begin += len(part)
        return states

    def _touch_down(self) -> None:
        """Let what was learned in the last contact be a prior: the wall may be another."""
        if self._p.tracking.restarts:
            self._tracker.touch_down(self.estimator)
            self.monitor.reset()
            self._start_collecting()
            self._judged = False
            self._past.clear()
            self._predict()

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
            self._errors.note_update(frozen)
            estimates = self.estimator.update(part[begin:end], variance, frozen)
            widened = map(self._widen, estimates)
            states += zip(widened, repeat(EstimateStatus.ESTIMATING), repeat(reason))
        return self._checked(states)

    def _current(self) -> ParameterEstimate:
        return self._widen(self.estimator.current())

    def _widen(self, estimate: ParameterEstimate) -> ParameterEstimate:
        """Add systematic errors to the deviations: once, for every estimator."""
        widened = self._errors.widen(self._noise.widen(estimate))
        robot = self._p.robot
        if robot.compliance or robot.compliance_std:
            return of_the_wall(widened, robot)
        return widened

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
        elapsed_s = len(self._rows) / self._p.sample_rate
        self._pass_to_monitor()
        self._judge_noise(force_variance)
        change = self._tracker.follow(
            self.monitor, estimator, self._noise.variance, force_variance, elapsed_s
        )
        if change is Change.WALL or change is Change.LOCATION:
            self._judge_noise(force_variance)
        self._judged = True
        self.monitor.judge(
            self._noise.variance,
            max(estimator.stiffness, 0.1 * environment.initial_stiffness),
            max(estimator.damping, environment.initial_damping, 1e-3),
            estimator.location_std,
        )
        if change is not Change.NONE:
            self._learn_again(change, max(force_variance, self._noise.variance))
        completed = self.monitor.completed
        if completed < _EARLY_BLOCKS or completed >= self._judged_blocks + _JUDGED_TOGETHER:
            self._judge_errors(force_variance)
        self._start_collecting()
        self._predict()

    def _judge_errors(self, force_variance: float) -> None:
        self._judged_blocks = self.monitor.completed
        K, position_noise = self.estimator.stiffness, self._p.contact.position_noise
        self._errors.judge(
            self.monitor.blocks, self._noise.variance,
            force_variance + (K * position_noise) * (K * position_noise), position_noise,
            self._tracker.shift_std, self.estimator,
        )

    def _learn_again(self, change: Change, variance: float) -> None:
        """Update a restarted estimator with the last rows, which are those of the wall it met."""
        if change is Change.WALL:
            while len(self._past) > RECENT:
                self._past.popleft()
        frozen = self.monitor.frozen
        if not (frozen.stiffness and frozen.damping):
            self._noise.note_update(frozen)
            self._errors.note_update(frozen)
            self.estimator.update(
                _shifted(list(self._past), self._tracker.shift), variance, frozen)

    def _judge_noise(self, force_variance: float) -> None:
        self._noise.judge(
            self.monitor.window(), force_variance, self._p.contact.position_noise, self.estimator
        )

    def _pass_to_monitor(self) -> None:
        """Pass the collected rows to the monitor, linearised about the last judged estimate."""
        linear = self._linear
        self.monitor.add([linear(row) if linear else row for _, row in self._rows], self._gains)

    def _start_collecting(self) -> None:
        self._rows: list[TimedRow] = []  # with the surface where it is
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


def _shifted(part: list[TimedRow], shift: float) -> list[TimedRow]:
    """Return rows with the surface moved, which the linear filter passes unchanged."""
    return [
        (dt, (row[0], row[1] - shift * row[3], row[2], row[3], row[4])) for dt, row in part
    ]
