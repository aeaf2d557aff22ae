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
from ..estimators.excitation_monitor import ExcitationMonitor
from ..estimators.row_sums import RECENT
from ..estimators.systematic_errors import SystematicErrors
from ..signals.conditioning import Conditioned, stretches
from ..signals.relations import NoiseGain, Row

_BOTH = Frozen(True, True)
_ESTIMATING = EstimateStatus.ESTIMATING  # an enumeration takes long to look up
_FROZEN_REASONS = {
    Frozen(False, False): '',
    Frozen(False, True): 'damping frozen: weak excitation',
    Frozen(True, False): 'stiffness frozen: weak excitation',
    _BOTH: 'weak excitation',
}
_WAITING = 'waiting for consecutive samples'
_NOT_PREDICTED = 'predicted force within the noise'
_NOT_FINITE = 'estimate was not finite; reset to the initial values'
_EARLY_BLOCKS = 5  # during which errors are judged more often
_JUDGED_TOGETHER = 4  # blocks, later
_WAITS = 2  # blocks between judgements of a settled estimate
_LEARNT_AGAIN = 250  # rows after a restart
_NEW_CONTACT_S = 0.05  # out of contact, after which a contact is a new one
State = tuple[ParameterEstimate, EstimateStatus, str]


class SupervisedEstimator:
    """
    An estimator, the monitor of its excitation and the noise of its equation.

    The monitor decides at fixed counts of rows which parameters are updated: every ten rows at
    first and while the last ones contradict the estimate, later once a block of the window. Rows
    are collected in between, so that the estimates do not depend on how the samples are cut into
    runs.

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
        self._set(parameters)
        self.estimator = self._new_estimator()
        self.monitor = ExcitationMonitor(parameters.excitation, 1.0 / parameters.sample_rate)
        self._start()

    def _set(self, parameters: EstimationParameters) -> None:
        self._p = parameters
        self._longest = 2.0 / parameters.sample_rate  # never integrate over a gap
        self._robot_is_stiff = not (
            parameters.robot.compliance or parameters.robot.compliance_std)

    def _new_estimator(self) -> OnlineEstimator:
        p = self._p
        tuning = getattr(p.tuning, p.estimator)
        return ESTIMATORS[p.estimator](tuning, p.environment, 1.0 / p.sample_rate)

    def _start(self) -> None:
        p = self._p
        self._noise = EquationNoise(p.contact.force_noise**2)
        self._errors = SystematicErrors(p.synchronisation.timing_std)
        self._start_contacts()
        self._start_collecting()
        self._predict()

    def _start_contacts(self) -> None:
        p = self._p
        self._tracker = WallTracker(
            p.tracking, p.environment.location_std, p.contact.position_noise,
            p.synchronisation.timing_std)
        self._surface = self._tracker.surface
        self._free_s = 0.0
        self._judged_rows = 0  # in this contact
        self._judged_blocks = 0
        self._past: deque[TimedRow] = deque(maxlen=_LEARNT_AGAIN)  # rows of this wall

    def configure(self, parameters: EstimationParameters) -> None:
        """
        Set new parameters while running; a new estimator starts from the present K_hat and B_hat.

        Parameters
        ----------
        parameters : EstimationParameters
            All parameters.

        """
        old = self._p
        self._set(parameters)
        self._errors.timing_std = parameters.synchronisation.timing_std
        rate_changed = parameters.sample_rate != old.sample_rate
        self._pass_to_monitor()
        if rate_changed or parameters.estimator != old.estimator:
            self._switch()
        if parameters.environment != old.environment or parameters.tuning != old.tuning:
            self.estimator.environment = parameters.environment
            self.estimator.configure(getattr(parameters.tuning, parameters.estimator))
        if parameters.environment.location != old.environment.location:
            self._start_contacts()
        self._tracker.configure(
            parameters.tracking, parameters.environment.location_std,
            parameters.contact.position_noise, parameters.synchronisation.timing_std)
        if rate_changed:
            self.monitor = ExcitationMonitor(parameters.excitation, 1.0 / parameters.sample_rate)
            self._judged_blocks = 0
        elif parameters.excitation != old.excitation:
            self.monitor.configure(parameters.excitation)
        self._start_collecting()
        self._predict()

    def _switch(self) -> None:
        stiffness, damping = self.estimator.stiffness, self.estimator.damping
        self.estimator = self._new_estimator()
        self.estimator.start_from(*self.estimator.within_limits(stiffness, damping))
        self._errors = SystematicErrors(self._p.synchronisation.timing_std)

    def reset(self) -> None:
        """Reset the estimate to its initial values, and excitation and noise with it."""
        self.estimator.reset()
        self.monitor.reset()
        self._start()

    @property
    def hindrance(self) -> str:
        """What hinders the estimator on the present contact; '' for nothing."""
        return self.estimator.hindrance(self.monitor.sums.window().products)

    @property
    def shift(self) -> float:
        """Estimated location less the configured one [m], the same for every estimator."""
        return self._surface.shift

    @property
    def location_unchecked(self) -> bool:
        """Whether the present contact has not shown where its surface is."""
        return self._tracker.location_unchecked

    # -- samples ----------------------------------------------------------------------------

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

    def take(
        self, dt: float, touching: bool, force_variance: float, row: Row | None, gain: NoiseGain
    ) -> State:
        """
        Update the estimate with one sample, as `process` does with many.

        Parameters
        ----------
        dt, touching, force_variance, row, gain
            Of `Conditioned`.

        Returns
        -------
        state : (ParameterEstimate, EstimateStatus, str)
            Estimate, status and reason after the sample.

        """
        if row is None:
            return self._keep((dt,), (touching,))[0]
        return self._update((dt,), (row,), (gain,), force_variance)[0]

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
        longest = self._longest
        timed: list[TimedRow] = [
            (dt if dt < longest else longest, row) for dt, row in zip(dts, rows) if row
        ]
        if self._free_s:
            if self._free_s >= _NEW_CONTACT_S and self._judged_rows:
                self._touch_down()
            self._free_s = 0.0
        if len(timed) < self._wanted:  # the usual case
            return self._update_part(timed, gains, force_variance)
        states: list[State] = []
        begin = 0
        while begin < len(timed):
            part = slice(begin, begin + self._wanted)
            states += self._update_part(timed[part], gains[part], force_variance)
            begin = part.stop
            if self._wanted == 0:
                self._complete_chunk(force_variance)
        return states

    def _touch_down(self) -> None:
        """Let what was learned in the last contact be a prior: the wall may be another."""
        if self._p.tracking.restarts:
            self._tracker.touch_down(self.estimator)
            self.monitor.reset()
            self._start_collecting()
            self._judged_rows = self._judged_blocks = 0
            self._past.clear()
            self._predict()

    def _update_part(
        self, part: list[TimedRow], gains: Sequence[NoiseGain], force_variance: float
    ) -> list[State]:
        """Update with rows of one chunk, where the predicted force is above noise."""
        self._wanted -= len(part)
        self._past += part
        shift = self._surface.shift
        if shift:
            part = _shifted(part, shift)
        self._chunk += part
        self._gains += gains
        frozen, reason = self._frozen
        if frozen is _BOTH:
            return [(self._current(), EstimateStatus.FROZEN, reason)] * len(part)
        estimator, variance = self.estimator, self._noise.variance
        if force_variance > variance:
            variance = force_variance
        K, B, floor = self._prediction
        predicted = [K * row[1] + B * row[2] > floor for _, row in part]
        states: list[State] = []
        parts = stretches(predicted) if False in predicted else ((0, len(part)),)
        for begin, end in parts:
            if not predicted[begin]:
                waits: State = self._current(), EstimateStatus.FROZEN, _NOT_PREDICTED
                states += [waits] * (end - begin)
                continue
            self._errors.note_update(frozen)
            for estimate in self._widen(estimator.update(part[begin:end], variance, frozen)):
                states.append((estimate, _ESTIMATING, reason))
        if isfinite(estimator.stiffness) and isfinite(estimator.damping):
            return states
        return self._restarted(len(states))

    def _restarted(self, count: int) -> list[State]:
        """Reset the estimator, whose estimate is not finite."""
        self.estimator.reset()
        return [(self._current(), EstimateStatus.FROZEN, _NOT_FINITE)] * count

    def _current(self) -> ParameterEstimate:
        return self._widen([self.estimator.current()])[0]

    def _widen(self, estimates: list[ParameterEstimate]) -> list[ParameterEstimate]:
        """Add systematic errors to the deviations: once, for every estimator."""
        widened = self._errors.widen(estimates)
        if self._robot_is_stiff:
            return widened
        return [of_the_wall(estimate, self._p.robot) for estimate in widened]

    # -- judgements -------------------------------------------------------------------------

    def _complete_chunk(self, force_variance: float) -> None:
        """Judge the estimate, unless nothing has changed within a block of the window."""
        self._pass_to_monitor()
        sums, rows = self.monitor.sums, self._linearised(self._chunk)
        self._rows += rows
        self._chunk = []
        at_end = len(self._rows) >= sums.left
        due = at_end and (not sums.full or (sums.completed + 1) % _WAITS == 0)
        if due or not sums.full or not self._tracker.may_wait(rows, self.estimator):
            self._pass_to_monitor()
            self._judge_excitation(force_variance)
            sums.close_block()
            completed = sums.completed
            if completed < _EARLY_BLOCKS or completed >= self._judged_blocks + _JUDGED_TOGETHER:
                self._judged_blocks = completed
                self._judge_errors(force_variance)
            self._predict()
        elif at_end:
            self._pass_to_monitor()
            sums.close_block()
        self._wanted = min(sums.wanted, sums.left - len(self._rows))

    def _judge_excitation(self, force_variance: float) -> None:
        """Let the monitor judge which parameters the collected rows excite."""
        estimator, environment, monitor = self.estimator, self._p.environment, self.monitor
        self._judge_noise(force_variance)
        change = self._tracker.follow(
            monitor.sums, estimator, self._noise.variance, force_variance,
            self._judged_rows / self._p.sample_rate,
        )
        if change is Change.WALL or change is Change.LOCATION:
            self._judge_noise(force_variance)
        self._errors.judge_position(
            monitor.sums.window(), self._p.contact.position_noise, estimator)
        monitor.judge(
            self._noise.variance,
            max(estimator.stiffness, 0.1 * environment.initial_stiffness),
            max(estimator.damping, environment.initial_damping, 1e-3),
            estimator.location_std,
        )
        if change is not Change.NONE:
            self._learn_again(change, max(force_variance, self._noise.variance))

    def _judge_errors(self, force_variance: float) -> None:
        K, position_noise = self.estimator.stiffness, self._p.contact.position_noise
        self._errors.judge(
            self.monitor.sums.blocks, self._noise.variance,
            force_variance + (K * position_noise) * (K * position_noise), position_noise,
            self._tracker.surface.shift_std, self.estimator,
        )

    def _learn_again(self, change: Change, variance: float) -> None:
        """Update a restarted estimator with the last rows, which are those of the wall it met."""
        if change is Change.WALL:
            while len(self._past) > RECENT:
                self._past.popleft()
        frozen = self.monitor.frozen
        if not (frozen.stiffness and frozen.damping):
            self._errors.note_update(frozen)
            self.estimator.update(
                _shifted(list(self._past), self._tracker.surface.shift), variance, frozen)

    def _judge_noise(self, force_variance: float) -> None:
        self._noise.judge(
            self.monitor.sums.window(), force_variance, self._p.contact.position_noise,
            self.estimator)

    def _linearised(self, chunk: list[TimedRow]) -> list[Row]:
        """Return rows linearised about the last judged estimate."""
        linear = self._linear
        return [linear(row) if linear else row for _, row in chunk]

    def _pass_to_monitor(self) -> None:
        """Pass the collected rows to the monitor."""
        self._rows += self._linearised(self._chunk)
        self._judged_rows += len(self._rows)
        self.monitor.sums.add(self._rows, self._gains)
        self._start_collecting()

    def _start_collecting(self) -> None:
        self._chunk: list[TimedRow] = []  # with the surface where it is
        self._rows: list[Row] = []  # of complete chunks, linearised
        self._gains: list[NoiseGain] = []
        self._wanted = self.monitor.sums.wanted

    def _predict(self) -> None:
        """Store what holds for the rows until the next judgement."""
        frozen = self.monitor.frozen
        self._frozen = _BOTH if frozen == _BOTH else frozen, _FROZEN_REASONS[frozen]
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
