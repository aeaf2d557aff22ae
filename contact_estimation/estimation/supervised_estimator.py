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

from .parameters import EstimationParameters
from .robot_compliance import of_the_wall
from .supervision import ALL, Supervision
from ..estimators import ESTIMATORS
from ..estimators.estimate import EstimateStatus, Frozen, ParameterEstimate
from ..estimators.estimator import OnlineEstimator, TimedRow
from ..estimators.excitation_monitor import ExcitationMonitor
from ..signals.relations import NoiseGain, Row

# An enumeration takes long to look up.
_FREE, _ESTIMATING, _FROZEN = (
    EstimateStatus.FREE, EstimateStatus.ESTIMATING, EstimateStatus.FROZEN)
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
        self._kept: ParameterEstimate | None = None  # the estimate, as long as it stays

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
        self._kept = None

    def reset(self) -> None:
        """Reset the estimate to its initial values, and excitation and noise with it."""
        self.estimator.reset()
        self._supervision = Supervision(self._p, self.estimator)
        self._free_s = 0.0
        self._kept = None

    def take_location(self, std: float) -> None:
        """Use another location of the surface, with its standard deviation [m]."""
        self._supervision.take_location(std)
        self._kept = None

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

    def take(
        self, dt: float, touching: bool, force_variance: float, row: Row | None, gain: NoiseGain
    ) -> State:
        """
        Update the estimate with the next sample, where it has a row.

        Parameters
        ----------
        dt, touching, force_variance, row, gain
            As of `Conditioner.take`.

        Returns
        -------
        state : (ParameterEstimate, EstimateStatus, str)
            Estimate, status and reason after the sample.

        """
        if row is None:
            return self._keep(dt, touching)
        supervision = self._supervision
        self._kept = None
        if self._free_s:
            if self._free_s >= _NEW_CONTACT_S:
                supervision.touch_down()
                supervision.touched_down = True
            self._free_s = 0.0
        state = self._update((dt if dt < self._longest else self._longest, row), gain,
                             force_variance)
        if supervision.wanted == 0:
            supervision.complete_chunk(force_variance)
        return state

    def _keep(self, dt: float, touching: bool) -> State:
        """Keep the estimate: out of contact, or while consecutive samples are lacking."""
        kept = self._kept
        if kept is None:
            kept = self._current()
            # What is observed out of contact may change an estimate.
            self._kept = None if self.estimator.follows_reference else kept
        if touching:
            return kept, _FROZEN, _WAITING
        self._free_s += dt
        return kept, _FREE, ''

    def _update(self, timed: TimedRow, gain: NoiseGain, force_variance: float) -> State:
        """Update with a row, where the predicted force is above noise."""
        supervision, estimator = self._supervision, self.estimator
        rows = supervision.collect([timed], (gain,))
        frozen = supervision.frozen
        if frozen is ALL:
            return self._current(), _FROZEN, _FROZEN_REASONS[ALL]
        row, (K, B, floor) = rows[0][1], supervision.prediction
        if not K * row[1] + B * row[2] > floor:
            return self._current(), _FROZEN, _NOT_PREDICTED
        supervision.errors.note_update(frozen)
        variance = supervision.noise.variance
        updated = estimator.update(
            rows, variance if variance > force_variance else force_variance, frozen)
        (estimate,) = self._widen(updated)
        if isfinite(estimator.stiffness) and isfinite(estimator.damping):
            return estimate, _ESTIMATING, _FROZEN_REASONS[frozen]
        return self._restarted()

    def _restarted(self) -> State:
        """Reset the estimator, whose estimate is not finite."""
        self.estimator.reset()
        return self._current(), _FROZEN, _NOT_FINITE

    def _current(self) -> ParameterEstimate:
        return self._widen([self.estimator.current()])[0]

    def _widen(self, estimates: list[ParameterEstimate]) -> list[ParameterEstimate]:
        """Add systematic errors to the deviations: once, for every estimator."""
        widened = self._supervision.errors.widen(estimates)
        if self._robot_is_stiff:
            return widened
        return [of_the_wall(estimate, self._p.robot) for estimate in widened]
