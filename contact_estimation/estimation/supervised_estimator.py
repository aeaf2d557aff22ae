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

from math import isfinite, sqrt

from .parameters import EstimationParameters
from .robot_compliance import of_the_wall, with_joints
from .supervision import ALL, shifted, Supervision
from ..estimators import ESTIMATORS
from ..estimators.estimate import EstimateStatus, ParameterEstimate
from ..estimators.estimator import OnlineEstimator, TimedRow, UNKNOWN_DAMPING_S
from ..estimators.excitation_monitor import ExcitationMonitor
from ..estimators.systematic_errors import SystematicErrors
from ..signals.relations import NoiseGain, Row

# An enumeration takes long to look up.
_FREE, _ESTIMATING, _FROZEN = (
    EstimateStatus.FREE, EstimateStatus.ESTIMATING, EstimateStatus.FROZEN)
_WAITING = 'waiting for consecutive samples'
_NOT_PREDICTED = 'predicted force within the noise'
_ROW_NOT_FINITE = 'sample left out: force or motion is not finite'
_NOT_FINITE = 'estimate was not finite; reset to the initial values'
_NEW_CONTACT_S = 0.05  # out of contact, after which a contact is a new one
Parameters = tuple[float, float, float, float, float, float]
"""The fields of a `ParameterEstimate`, which as a tuple takes a tenth of the time to make."""

State = tuple[Parameters, EstimateStatus, str]


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
        self._kept: Parameters | None = None  # the estimate, as long as it stays

    def _set(self, parameters: EstimationParameters) -> None:
        self._p = parameters
        self._longest = 2.0 / parameters.sample_rate  # never integrate over a gap
        self._robot = with_joints(parameters.robot, parameters.physics)
        self._robot_is_stiff = not (self._robot.compliance or self._robot.compliance_std)

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
        state : (Parameters, EstimateStatus, str)
            Estimate, status and reason after the sample.

        """
        if row is None:
            return self._keep(dt, touching)
        total = row[0] + row[1] + row[2] + row[3] + row[4]
        if total - total != 0.0:  # not finite: in no sum, and in no filter of the estimator
            return self._keep(dt, touching)[0], _FROZEN, _ROW_NOT_FINITE
        supervision = self._supervision
        self._kept = None
        if self._free_s:
            self._begin_contact()
        timed = dt if dt < self._longest else self._longest, row
        supervision.past.append(timed)
        shift = supervision.tracker.surface.shift
        if shift:
            timed = shifted(timed, shift)
        supervision.chunk.append(timed)
        supervision.gains.append(gain)
        state = self._update(timed, force_variance)
        if len(supervision.chunk) == supervision.wanted:
            supervision.judge(force_variance)
        return state

    def _begin_contact(self) -> None:
        """End a free flight; after a short one, the contact is the one before."""
        if self._free_s >= _NEW_CONTACT_S:
            self._supervision.touch_down()
            self._supervision.touched_down = True
        self._free_s = 0.0

    def _keep(self, dt: float, touching: bool) -> State:
        """Keep the estimate: out of contact, or while consecutive samples are lacking."""
        kept = self._kept
        if kept is None:
            kept = self._widened(self.estimator.current())
            # What is observed out of contact may change an estimate.
            self._kept = None if self.estimator.follows_reference else kept
        if touching:
            return kept, _FROZEN, _WAITING
        self._free_s += dt
        return kept, _FREE, ''

    def _update(self, timed: TimedRow, force_variance: float) -> State:
        """Update with a row, where the predicted force is above noise."""
        supervision, estimator = self._supervision, self.estimator
        frozen = supervision.frozen
        if frozen is ALL:
            return self._widened(estimator.current()), _FROZEN, supervision.frozen_reason
        row, (K, B, floor) = timed[1], supervision.prediction
        if not K * row[1] + B * row[2] > floor:
            return self._widened(estimator.current()), _FROZEN, _NOT_PREDICTED
        errors, variance = supervision.errors, supervision.noise.variance
        if frozen is not errors.noted:
            errors.note_update(frozen)
        (estimate,) = estimator.update(
            (timed,), variance if variance > force_variance else force_variance, frozen)
        if isfinite(estimate[0]) and isfinite(estimate[1]):
            return self._widened(estimate), _ESTIMATING, supervision.frozen_reason
        estimator.reset()
        return self._widened(estimator.current()), _FROZEN, _NOT_FINITE

    def _widened(self, estimate: ParameterEstimate) -> Parameters:
        """Add systematic errors to the deviations: once, for every estimator."""
        wide = widened(estimate, self._supervision.errors)
        return wide if self._robot_is_stiff else of_the_wall(wide, self._robot)


def widened(estimate: Parameters, errors: SystematicErrors) -> Parameters:
    """
    Return an estimate with systematic errors added to its standard deviations.

    Parameters
    ----------
    estimate : Parameters
        With the standard deviations of the estimator, for white noise of the equation.
    errors : SystematicErrors
        Of the estimator.

    Returns
    -------
    widened : Parameters
        NaN stays NaN, and is the deviation of what never was updated: an initial value.

    """
    K, B, K_std, B_std, shift, inertia = estimate
    (K_factor, K_error, K_share), (B_factor, B_error, B_share) = errors.learned
    K_more, B_more, lag = K_share * K, B_share * B, K * errors.timing_std
    K_variance = (K_std * K_std + K_more * K_more) * K_factor + K_error
    B_variance = (B_std * B_std + B_more * B_more) * B_factor + B_error + lag * lag
    if errors.coupled and K_variance == K_variance:  # B_hat was fitted beside K_hat
        B_variance += UNKNOWN_DAMPING_S * UNKNOWN_DAMPING_S * K_variance
    return K, B, sqrt(K_variance), sqrt(B_variance), shift, inertia
