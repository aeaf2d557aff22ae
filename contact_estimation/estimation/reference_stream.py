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

"""The reference that accompanies each sample, from the planner's setpoints and the estimate."""

from __future__ import annotations

from collections import Counter, deque
from math import inf, isfinite, isnan, nan

from .parameters import EstimationParameters
from .robot_compliance import seen_by_the_robot, with_joints
from ..estimators.estimate import Estimate, EstimateStatus
from ..reference.reference_generator import ReferenceGenerator
from ..reference.setpoints import Desired, Reference
from ..signals.contact_sample import ContactSample

_MAX_SETPOINTS = 100_000  # that no sample has reached yet; older ones are dropped beyond
_BEFORE_ANY = -(2**63)
_FREE = EstimateStatus.FREE  # an enumeration takes long to look up


class ReferenceStream:
    """
    Compute one reference per sample from the setpoints.

    Parameters
    ----------
    parameters : EstimationParameters
        All parameters.
    rejected : Counter
        Where rejected setpoints are counted, by reason.

    """

    def __init__(self, parameters: EstimationParameters, rejected: Counter[str]) -> None:
        self._rejected = rejected
        self._generator = ReferenceGenerator(parameters.reference_law, parameters.reference)
        self._setpoints: deque[tuple[int, Desired]] = deque(maxlen=_MAX_SETPOINTS)
        self._resting = Desired(nan, 0.0, 0.0, nan)
        self.configure(parameters)
        self.restart()

    def configure(self, parameters: EstimationParameters) -> None:
        """
        Set new parameters while running; x_r stays continuous.

        Parameters
        ----------
        parameters : EstimationParameters
            All parameters.

        """
        self._generator.configure(
            parameters.reference_law, parameters.reference, 1.0 / parameters.sample_rate
        )
        self._maximum_depth = parameters.reference.maximum_depth
        self._deepest = parameters.environment.location + self._maximum_depth
        self._takes_location = isnan(parameters.environment.location)
        self._timeout_s = parameters.synchronisation.timeout_s
        self._default_force = parameters.force_reference
        self._resting = Desired(self._resting.position, 0.0, 0.0, self._default_force)
        self._robot = with_joints(parameters.robot, parameters.physics)
        self.period_ns = round(1e9 / parameters.sample_rate)

    def restart(self) -> None:
        """Start afresh with the next sample, as after a backward clock jump."""
        self._generator.reset()
        self._start_ns = self._last_ns = _BEFORE_ANY
        self._resting = Desired(nan, 0.0, 0.0, self._default_force)  # until the first sample

    def add(self, stamp_ns: int, desired: Desired) -> None:
        """
        Add a setpoint of the planner.

        Parameters
        ----------
        stamp_ns : int
            Instant from which it holds [ns].
        desired : Desired
            Position with derivatives and force. A position that is not finite is rejected; a
            force <= 0 counts as none, derivatives that are not finite as 0.

        """
        if not isfinite(desired.position):
            self._rejected['desired_not_finite'] += 1
            return
        force = desired.force
        if not 0.0 < force < inf:
            if force == force and force != 0.0:  # NaN and 0 mean that no force is desired
                self._rejected['desired_force_not_positive'] += 1
            force = nan
        v, a = (rate if isfinite(rate) else 0.0 for rate in desired[1:3])
        if self._setpoints and stamp_ns < self._setpoints[-1][0]:
            self._setpoints.clear()  # the clock jumped back, or the planner has replanned
        self._setpoints.append((stamp_ns, Desired(desired.position, v, a, force)))

    def step(self, sample: ContactSample, estimate: Estimate) -> Reference:
        """
        Compute the reference for one sample period after a sample.

        Parameters
        ----------
        sample : ContactSample
            Of the contact axis.
        estimate : Estimate
            After that sample.

        Returns
        -------
        reference : Reference
            x_r with derivatives.

        """
        stamp_ns, position, _, _ = sample
        period_ns, last_ns, self._last_ns = self.period_ns, self._last_ns, stamp_ns
        if last_ns == _BEFORE_ANY:
            elapsed, self._start_ns = period_ns * 1e-9, stamp_ns
            self._generator.start(position)
            self._resting = Desired(position, 0.0, 0.0, self._default_force)
        else:
            elapsed, longest = (stamp_ns - last_ns) * 1e-9, 2.0 * (period_ns * 1e-9)
            if elapsed > longest:  # the robot still is where the last reference left it
                elapsed = longest
        target_ns = stamp_ns + period_ns
        desired = self._setpoint_at(target_ns) if self._setpoints else self._resting
        _, K_hat, _, _, _, location, _, status, _, _ = estimate
        contact, deepest = status is not _FREE, self._deepest
        if self._takes_location:  # no force law without x_e
            contact = contact and not isnan(location)
            deepest = deepest if isnan(location) else location + self._maximum_depth
        return self._generator.step(
            (target_ns - self._start_ns) * 1e-9, elapsed, desired, contact, location,
            seen_by_the_robot(K_hat, self._robot) if self._robot.compliance else K_hat,
            deepest,
        )

    @property
    def limited(self) -> bool:
        """Whether a limit keeps the last reference away from what it should be."""
        return self._generator.limited

    def _setpoint_at(self, stamp_ns: int) -> Desired:
        """
        Return the newest setpoint at an instant; before any, the position of the first sample.

        A setpoint older than the timeout is a position to rest at: its rates no longer apply.

        """
        setpoints = self._setpoints
        while len(setpoints) > 1 and setpoints[1][0] <= stamp_ns:
            setpoints.popleft()  # superseded; by stamps, so that a latency never loses one
        if setpoints and setpoints[0][0] <= stamp_ns:
            stamp, desired = setpoints[0]
            if (stamp_ns - stamp) * 1e-9 <= self._timeout_s:
                return desired
            return Desired(desired.position, 0.0, 0.0, desired.force)
        return self._resting
