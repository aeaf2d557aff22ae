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

"""Supervision of an estimator: excitation, noise, systematic errors, a wall that changes."""

from __future__ import annotations

from collections import deque

from .parameters import EstimationParameters
from .wall_tracking import Change, WallTracker
from ..estimators.equation_noise import EquationNoise
from ..estimators.estimate import Frozen
from ..estimators.estimator import OnlineEstimator, TimedRow
from ..estimators.excitation_monitor import ExcitationMonitor
from ..estimators.row_sums import RECENT
from ..estimators.systematic_errors import SystematicErrors
from ..estimators.wall_fit import wall_of
from ..signals.relations import NoiseGain, Row

ALL = Frozen(True, True)
_FROZEN_REASONS = {
    Frozen(False, False): '',
    Frozen(False, True): 'damping frozen: weak excitation',
    Frozen(True, False): 'stiffness frozen: weak excitation',
    ALL: 'weak excitation',
}
_EARLY_BLOCKS = 5  # during which errors are judged more often
_JUDGED_TOGETHER = 4  # blocks, later
_WAITS = 2  # blocks between judgements of a settled estimate
_ANYWHERE = 1.0  # standard deviation of a surface that no touch-down has checked [m]
_LEARNT_AGAIN = 250  # rows after a restart


class Supervision:
    """
    Judges an estimate at fixed counts of rows.

    Every ten rows at first and while the last ones contradict the estimate, later every second
    block of the window. Rows are collected in between, by `SupervisedEstimator`: `judge` is due
    when `chunk` has as many as `wanted`.

    Parameters
    ----------
    parameters : EstimationParameters
        All parameters.
    estimator : OnlineEstimator
        The estimator.

    Attributes
    ----------
    monitor : ExcitationMonitor
        Which parameters are excited.
    noise : EquationNoise
        Of the equation that is fitted.
    errors : SystematicErrors
        Of the estimates.
    tracker : WallTracker
        Follows a wall that changes, and its surface.
    touched_down : bool
        Whether the present contact has been seen to begin: a check of the location.
    frozen : Frozen
        Parameters that are not updated; the object `ALL` where both are.
    frozen_reason : str
        Which they are, '' where both are updated.
    prediction : tuple of float
        K_hat [N/m], B_hat [N s/m], and the force above which they are updated [N].
    chunk : list of (float, row)
        Rows since the last call of `judge`, with the surface where it has been found.
    gains : list of NoiseGain
        How noise enters the rows since the last judgement.
    past : deque of (float, row)
        Rows of this wall, with the surface where it is configured.
    wanted : int
        Number of rows of the next chunk.

    """

    def __init__(self, parameters: EstimationParameters, estimator: OnlineEstimator) -> None:
        self._p, self._estimator = parameters, estimator
        self.monitor = ExcitationMonitor(parameters.excitation, 1.0 / parameters.sample_rate)
        self.noise = EquationNoise(parameters.contact.force_noise**2)
        self.errors = SystematicErrors(parameters.synchronisation.timing_std)
        self._start_contacts()
        self._start_collecting()
        self._prepare()

    def _start_contacts(self) -> None:
        p = self._p
        self.touched_down = False
        self.tracker = WallTracker(
            p.tracking, p.environment.location_std, p.contact.position_noise,
            p.synchronisation.timing_std)
        self._judged_rows = self._judged_blocks = 0  # of this contact
        self.past: deque[TimedRow] = deque(maxlen=_LEARNT_AGAIN)

    def configure(self, parameters: EstimationParameters, estimator: OnlineEstimator) -> None:
        """
        Set new parameters while running; what is known of the contact stays.

        Parameters
        ----------
        parameters : EstimationParameters
            All parameters.
        estimator : OnlineEstimator
            The estimator, possibly another one.

        """
        self._pass_to_monitor()
        old, self._p = self._p, parameters
        timing_std = parameters.synchronisation.timing_std
        if estimator is not self._estimator:
            self._estimator, self.errors = estimator, SystematicErrors(timing_std)
        self.errors.timing_std = timing_std
        if repr(parameters.environment.location) != repr(old.environment.location):  # or NaN
            self._start_contacts()
        self.tracker.configure(
            parameters.tracking, parameters.environment.location_std,
            parameters.contact.position_noise, timing_std)
        if parameters.sample_rate != old.sample_rate:
            self.monitor = ExcitationMonitor(parameters.excitation, 1.0 / parameters.sample_rate)
            self._judged_blocks = 0
        elif parameters.excitation != old.excitation:
            self.monitor.configure(parameters.excitation)
        self._start_collecting()
        self._prepare()

    def take_location(self, std: float) -> None:
        """Use another location of the surface, with its standard deviation [m]."""
        self._start_contacts()
        self.touched_down = True
        self.tracker.surface.doubt(std)

    def touch_down(self) -> None:
        """Let what was learned in the last contact be a prior: the wall may be another."""
        if self._p.tracking.restarts and self._judged_rows:
            self.tracker.touch_down(self._estimator)
            self.monitor.reset()
            self._start_collecting()
            self._judged_rows = self._judged_blocks = 0
            self.past.clear()
            self._prepare()

    def judge(self, force_variance: float) -> None:
        """
        Judge the estimate after a chunk, unless nothing has changed within a block of the window.

        Parameters
        ----------
        force_variance : float
            Of the force noise in free flight [N^2].

        """
        sums, rows = self.monitor.sums, self._linearised(self.chunk)
        self._rows += rows
        self.chunk.clear()
        at_end = len(self._rows) >= sums.left
        due = at_end and (not sums.full or (sums.completed + 1) % _WAITS == 0)
        if due or not sums.full or not self.tracker.may_wait(rows, self._estimator):
            self._pass_to_monitor()
            self._judge_excitation(force_variance)
            sums.close_block()
            completed = sums.completed
            if completed < _EARLY_BLOCKS or completed >= self._judged_blocks + _JUDGED_TOGETHER:
                self._judged_blocks = completed
                self._judge_errors(force_variance)
            self._prepare()
        elif at_end:
            self._pass_to_monitor()
            sums.close_block()
        self.wanted = min(sums.wanted, sums.left - len(self._rows))

    def _judge_excitation(self, force_variance: float) -> None:
        """Let the monitor judge which parameters the collected rows excite."""
        estimator, environment, monitor = self._estimator, self._p.environment, self.monitor
        self._judge_noise(force_variance)
        change = self.tracker.follow(
            monitor.sums, estimator, self.noise.variance, force_variance,
            self._judged_rows / self._p.sample_rate,
        )
        if change is Change.WALL or change is Change.LOCATION:
            self._judge_noise(force_variance)
        self.errors.judge_position(
            monitor.sums.window(), self._p.contact.position_noise, estimator)
        monitor.judge(
            self.noise.variance,
            max(estimator.stiffness, 0.1 * environment.initial_stiffness),
            max(estimator.damping, environment.initial_damping, 1e-3),
            estimator.location_std,
        )
        if change is not Change.NONE:
            self._learn_again(change, max(force_variance, self.noise.variance))

    def _judge_errors(self, force_variance: float) -> None:
        known = force_variance + self.tracker.position_variance(
            self.monitor.sums.window(), wall_of(self._estimator))
        self.errors.judge(
            self.monitor.sums.blocks, self.noise.variance, known,
            self._p.contact.position_noise,
            self._location_std(),
            self._estimator, self.monitor.sums.contact(),
        )

    def _location_std(self) -> float:
        """Return the prior standard deviation of x_e [m]."""
        std = self._p.environment.location_std or self.tracker.surface.taken_std
        return std if self.touched_down or std == 0.0 else _ANYWHERE

    def _learn_again(self, change: Change, variance: float) -> None:
        """Update a restarted estimator with the last rows, which are those of the wall it met."""
        if change is Change.WALL:
            while len(self.past) > RECENT:
                self.past.popleft()
        frozen = self.monitor.frozen
        if not (frozen.stiffness and frozen.damping):
            self.errors.note_update(frozen)
            self._estimator.update(
                [shifted(row, self.tracker.surface.shift) for row in self.past], variance, frozen)

    def _judge_noise(self, force_variance: float) -> None:
        self.noise.judge(
            self.monitor.sums.window(), force_variance, self._p.contact.position_noise,
            self._estimator)

    def _linearised(self, chunk: list[TimedRow]) -> list[Row]:
        """Return rows linearised about the last judged estimate."""
        linear = self._linear
        return [linear(row) if linear else row for _, row in chunk]

    def _pass_to_monitor(self) -> None:
        """Pass the collected rows to the monitor."""
        self._rows += self._linearised(self.chunk)
        self._judged_rows += len(self._rows)
        self.monitor.sums.add(self._rows, self.gains)
        self._start_collecting()

    def _start_collecting(self) -> None:
        self.chunk: list[TimedRow] = []
        self._rows: list[Row] = []  # of complete chunks, linearised
        self.gains: list[NoiseGain] = []
        self.wanted = self.monitor.sums.wanted

    def _prepare(self) -> None:
        """Store what holds for the rows until the next judgement."""
        frozen = self.monitor.frozen
        self.frozen = ALL if frozen == ALL else frozen
        self.frozen_reason = _FROZEN_REASONS[frozen]
        self._linear = self._estimator.linearisation()
        if self._estimator.estimates_location:
            self.prediction = 0.0, 0.0, -1.0  # no prediction before the location is known
            return
        K, B = self._estimator.stiffness, self._estimator.damping
        self.prediction = K, B, 3.0 * K * self._p.contact.position_noise


def shifted(timed: TimedRow, shift: float) -> TimedRow:
    """
    Return a row with the surface moved, which the linear filter passes unchanged.

    Parameters
    ----------
    timed : (float, row)
        The row.
    shift : float
        How far into the wall [m].

    """
    dt, (y, f_K, f_B, f_c, f_M) = timed
    return dt, (y, f_K - shift * f_c, f_B, f_c, f_M)
