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

from math import isfinite
from typing import Sequence

from .parameters import EstimationParameters
from .robot_compliance import of_the_wall
from .supervision import ALL, Supervision
from ..estimators import ESTIMATORS
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

_ESTIMATING = EstimateStatus.ESTIMATING  # an enumeration takes long to look up
_FROZEN_REASONS = {
    Frozen(False, False): '',
    Frozen(False, True): 'damping frozen: weak excitation',
    Frozen(True, False): 'stiffness frozen: weak excitation',
    ALL: 'weak excitation',
}
_WAITING = 'waiting for consecutive samples'
_NOT_PREDICTED = 'predicted force within the noise'
_NOT_FINITE = 'estimate was not finite; reset to the initial values'
_NEW_CONTACT_S = 0.05  # out of contact, after which a contact is a new one
State = tuple[ParameterEstimate, EstimateStatus, str]


class SupervisedEstimator:
    """
    An estimator that its supervision updates with informative rows alone.

    Parameters
    ----------
    parameters : EstimationParameters
        All parameters.

    Attributes
    ----------
    estimator : OnlineEstimator
        The estimator.

    """

    def __init__(self, parameters: EstimationParameters) -> None:
        self._set(parameters)
        self.estimator = self._new_estimator()
        self._supervision = Supervision(parameters, self.estimator)
        self._free_s = 0.0

    def _set(self, parameters: EstimationParameters) -> None:
        self._p = parameters
        self._longest = 2.0 / parameters.sample_rate  # never integrate over a gap
        self._robot_is_stiff = not (
            parameters.robot.compliance or parameters.robot.compliance_std)

    def _new_estimator(self) -> OnlineEstimator:
        p = self._p
        tuning = getattr(p.tuning, p.estimator)
        return ESTIMATORS[p.estimator](tuning, p.environment, 1.0 / p.sample_rate)

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
        if (parameters.sample_rate, parameters.estimator) != (old.sample_rate, old.estimator):
            K_hat, B_hat = self.estimator.stiffness, self.estimator.damping
            self.estimator = self._new_estimator()
            self.estimator.start_from(*self.estimator.within_limits(K_hat, B_hat))
        if parameters.environment != old.environment or parameters.tuning != old.tuning:
            self.estimator.environment = parameters.environment
            self.estimator.configure(getattr(parameters.tuning, parameters.estimator))
        self._supervision.configure(parameters, self.estimator)

    def reset(self) -> None:
        """Reset the estimate to its initial values, and excitation and noise with it."""
        self.estimator.reset()
        self._supervision = Supervision(self._p, self.estimator)
        self._free_s = 0.0

    def take_location(self, std: float) -> None:
        """Use another location of the surface, with its standard deviation [m]."""
        self._supervision.take_location(std)

    @property
    def monitor(self) -> ExcitationMonitor:
        """Return the excitation monitor."""
        return self._supervision.monitor

    @property
    def hindrance(self) -> str:
        """Return what hinders the estimator on the present contact; '' for nothing."""
        return self.estimator.hindrance(self.monitor.sums.window().products)

    @property
    def shift(self) -> float:
        """Estimated location less the configured one [m], the same for every estimator."""
        return self._supervision.tracker.surface.shift

    @property
    def location_unchecked(self) -> bool:
        """Whether the present contact has not shown where its surface is."""
        return self._supervision.tracker.location_unchecked

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
        supervision = self._supervision
        if self._free_s:
            if self._free_s >= _NEW_CONTACT_S:
                supervision.touch_down()
                supervision.touched_down = True
            self._free_s = 0.0
        if len(timed) < supervision.wanted:  # the usual case
            return self._update_part(timed, gains, force_variance)
        states: list[State] = []
        begin = 0
        while begin < len(timed):
            part = slice(begin, begin + supervision.wanted)
            states += self._update_part(timed[part], gains[part], force_variance)
            begin = part.stop
            if supervision.wanted == 0:
                supervision.complete_chunk(force_variance)
        return states

    def _update_part(
        self, part: list[TimedRow], gains: Sequence[NoiseGain], force_variance: float
    ) -> list[State]:
        """Update with rows of one chunk, where the predicted force is above noise."""
        supervision, estimator = self._supervision, self.estimator
        part = supervision.collect(part, gains)
        frozen = supervision.frozen
        reason = _FROZEN_REASONS[frozen]
        if frozen is ALL:
            return [(self._current(), EstimateStatus.FROZEN, reason)] * len(part)
        variance = supervision.noise.variance
        if force_variance > variance:
            variance = force_variance
        K, B, floor = supervision.prediction
        predicted = [K * row[1] + B * row[2] > floor for _, row in part]
        states: list[State] = []
        parts = stretches(predicted) if False in predicted else ((0, len(part)),)
        for begin, end in parts:
            if not predicted[begin]:
                waits: State = self._current(), EstimateStatus.FROZEN, _NOT_PREDICTED
                states += [waits] * (end - begin)
                continue
            supervision.errors.note_update(frozen)
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
        widened = self._supervision.errors.widen(estimates)
        if self._robot_is_stiff:
            return widened
        return [of_the_wall(estimate, self._p.robot) for estimate in widened]
