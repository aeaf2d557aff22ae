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

"""Model reference adaptive control in the structure of Singh and Popa (1995)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence

from .estimator import EnvironmentParameters, Held, OnlineEstimator, Reference, Snapshot, TimedRow
from .indirect_adaptive import IndirectAdaptive, IndirectAdaptiveParameters
from .model_following import ModelFollowing, ModelFollowingParameters
from ..parameters import group, ParameterGroup


@dataclass(frozen=True)
class ModelReferenceParameters(ParameterGroup):
    """Tuning of the controller of the arm and of the environment estimator."""

    control: ModelFollowingParameters = group(ModelFollowingParameters)
    environment: IndirectAdaptiveParameters = group(IndirectAdaptiveParameters)


class ModelReferenceAdaptive(OnlineEstimator):
    """
    A controller that makes an unknown arm follow the target impedance, and eq. (25) on top.

    The paper's four parts: the plant with unknown parameters and the estimator that adapts them
    to the reference model are in `ModelFollowing`, whose force drives a robot that is commanded
    by force; the environment estimator has the law and the gains of indirect_adaptive.

    """

    Parameters = ModelReferenceParameters
    follows_reference = True
    control_force = 0.0

    def __init__(
        self, tuning: ParameterGroup, environment: EnvironmentParameters, sample_period_s: float
    ) -> None:
        assert isinstance(tuning, ModelReferenceParameters)
        self.following = ModelFollowing(tuning.control)
        self._environment_estimator = IndirectAdaptive(
            tuning.environment, environment, sample_period_s
        )
        super().__init__(tuning, environment, sample_period_s)

    def configure(self, tuning: ParameterGroup) -> None:
        """Take new tuning; see `OnlineEstimator.configure`."""
        assert isinstance(tuning, ModelReferenceParameters)
        self._environment_estimator.configure(tuning.environment)
        self.following.configure(tuning.control)

    def start_from(self, stiffness: float, damping: float) -> None:
        """Begin anew; what is known of the arm stays. See `OnlineEstimator.start_from`."""
        self._environment_estimator.start_from(stiffness, damping)
        self.stiffness, self.damping = stiffness, damping

    def learn(
        self, rows: Sequence[TimedRow], noise_variance: float, held: Held
    ) -> list[Snapshot]:
        """Apply eq. (25); see `OnlineEstimator.learn`."""
        inner = self._environment_estimator
        inner.environment = self.environment
        snapshots = inner.learn(rows, noise_variance, held)
        self.stiffness, self.damping = inner.stiffness, inner.damping
        return snapshots

    def snapshot(self) -> Snapshot:
        """Tell what is known now; see `OnlineEstimator.snapshot`."""
        return self._environment_estimator.snapshot()

    def observe(
        self, dt: float, position: float, velocity: float, force: float, reference: Reference
    ) -> None:
        """Control the arm; see `OnlineEstimator.observe`."""
        if dt > 2.5 * self.sample_period_s:
            self.following.restart()  # nobody knows what the wall did during a gap
        self.control_force = self.following.force(dt, position, velocity, force, reference)
