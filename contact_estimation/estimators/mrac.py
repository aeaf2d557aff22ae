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
from math import nan, sqrt
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .estimator import EnvironmentParameters, Held, OnlineEstimator, Reference, Snapshot, TimedRow
from .model_following import ModelFollowing, ModelFollowingParameters
from ..parameters import group, parameter, ParameterGroup

_GAP_PERIODS = 2.5
"""Sample periods without a sample after which the model restarts at the arm."""


@dataclass(frozen=True)
class ModelReferenceParameters(ParameterGroup):
    """Tuning of the environment estimator and of the controller of the arm."""

    stiffness_gain: float = parameter(
        5.0e4, 'Entry of Gamma^-1 for K in eq. (25)', 'N/m/(N m s)', minimum=0.0
    )
    damping_gain: float = parameter(
        2.5e3, 'Entry of Gamma^-1 for B in eq. (25)', 'N s/m/(N m)', minimum=0.0
    )
    memory_s: float = parameter(
        1.0, 'Time over which eq. (25) is averaged; 0: eq. (25) as the paper has it, which '
        'without excitation keeps what a touch-down did to B', 's', minimum=0.0, maximum=60.0,
    )
    control: ModelFollowingParameters = group(ModelFollowingParameters)


class ModelReferenceAdaptive(OnlineEstimator):
    """
    A controller that makes an unknown arm follow the target impedance, and eq. (25) on top.

    The arm with its unknown parameters, the reference model and the adaptation that matches the
    two are in `ModelFollowing`; its force drives a robot that is commanded by force. The
    environment estimator is eq. (25) averaged over the last moments of contact,

        theta_hat_dot = -Gamma^-1 (R theta_hat - Q),
        T_m R_dot = phi phi^T - R,    T_m Q_dot = phi F - Q

    (Kreisselmeier 1977): with the Lyapunov function of eq. (24), V_dot = -2 theta_tilde^T R
    theta_tilde, where R has full rank as long as K and B were told apart within the memory T_m.
    T_m = 0 is eq. (25) itself.

    """

    Parameters = ModelReferenceParameters
    follows_reference = True
    control_force = 0.0

    def __init__(
        self, tuning: ParameterGroup, environment: EnvironmentParameters, sample_period_s: float
    ) -> None:
        assert isinstance(tuning, ModelReferenceParameters)
        self.following = ModelFollowing(tuning.control)
        super().__init__(tuning, environment, sample_period_s)

    def configure(self, tuning: ParameterGroup) -> None:
        """Take new tuning; see `OnlineEstimator.configure`."""
        assert isinstance(tuning, ModelReferenceParameters)
        self._p = tuning
        self.following.configure(tuning.control)

    # -- arm --------------------------------------------------------------------------------

    def observe(
        self, dt: float, position: float, velocity: float, force: float, reference: Reference
    ) -> None:
        """Control the arm; see `OnlineEstimator.observe`."""
        if dt > _GAP_PERIODS * self.sample_period_s:
            self.following.restart()
        self.control_force = self.following.force(dt, position, velocity, force, reference)

    # -- environment ------------------------------------------------------------------------

    def start_from(self, stiffness: float, damping: float) -> None:
        """Begin anew; what is known of the arm stays. See `OnlineEstimator.start_from`."""
        self.stiffness, self.damping = stiffness, damping
        self._seen_s = 0.0
        self._R: NDArray[np.float64] = np.zeros((2, 2))
        self._Q: NDArray[np.float64] = np.zeros(2)
        # Covariance of theta_hat and of the noise that Q remembers.
        self._P: NDArray[np.float64] = np.diag(
            [stiffness**2, max(damping**2, (1e-2 * stiffness) ** 2), 0.0, 0.0]
        )

    def learn(
        self, rows: Sequence[TimedRow], noise_variance: float, held: Held
    ) -> list[Snapshot]:
        """Apply the averaged eq. (25) over each sample; see `OnlineEstimator.learn`."""
        gains = np.diag([0.0 if held.stiffness else self._p.stiffness_gain,
                         0.0 if held.damping else self._p.damping_gain])
        snapshots = []
        for dt, row in rows:
            self._learn(dt, row[0], np.array(row[1:3]), gains, noise_variance)
            snapshots.append(self.snapshot())
        return snapshots

    def _learn(
        self, dt: float, F: float, phi: NDArray[np.float64], gains: NDArray[np.float64],
        noise_variance: float,
    ) -> None:
        # The plain mean since the start, then over the memory.
        self._seen_s = min(self._seen_s + dt, max(self._p.memory_s, dt))
        share = dt / self._seen_s if self._seen_s > 0.0 else 1.0
        keep, new = 1.0 - share, share * phi
        self._R = keep * self._R + np.outer(new, phi)
        self._Q = keep * self._Q + new * F
        # The implicit Euler step: stable at any gain and any sample period.
        S = dt * np.linalg.solve(np.eye(2) + dt * gains @ self._R, gains)
        theta = np.array([self.stiffness, self.damping])
        K, B = (theta - S @ (self._R @ theta - self._Q)).tolist()
        self.stiffness, self.damping = self.within_limits(K, B)
        A = np.eye(4)
        A[:2, :2] -= S @ self._R
        A[:2, 2:] = keep * S
        A[2:, 2:] *= keep
        b = np.concatenate([S @ new, new])
        self._P = A @ self._P @ A.T + noise_variance * np.outer(b, b)

    def snapshot(self) -> Snapshot:
        """Tell what is known now; see `OnlineEstimator.snapshot`."""
        K_std, B_std = (sqrt(max(float(self._P[i, i]), 0.0)) for i in range(2))
        return Snapshot(self.stiffness, self.damping, K_std, B_std, 0.0, nan)
