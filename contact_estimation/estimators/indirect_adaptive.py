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

"""Indirect adaptive estimation, eqs. (20) to (27) of Erickson, Weber and Sharf (2003)."""

from __future__ import annotations

from dataclasses import dataclass
from math import expm1, sqrt

from ..parameters import ParameterGroup, parameter
from ..signals.relations import Row
from .estimator import Held, OnlineEstimator

_SMALLEST = 1e-30
_MEMORY_S = 1.0  # of the mean squares that normalise


@dataclass(frozen=True)
class IndirectAdaptiveParameters(ParameterGroup):
    """Gains of eq. (25)."""

    stiffness_gain: float = parameter(
        5.0e4, 'Entry of Gamma^-1 for K; larger: faster, noisier', 'N/m/(N m s)', minimum=0.0
    )
    damping_gain: float = parameter(
        2.5e3, 'Entry of Gamma^-1 for B; larger: faster, noisier', 'N s/m/(N m)', minimum=0.0
    )
    normalised: bool = parameter(
        False,
        'Scale each gain by the mean square of its regressor instead: the same speed at any '
        'stiffness',
    )
    adaptation_rate: float = parameter(
        20.0, 'Decay rate of the force error when normalised', '1/s', minimum=0.0, maximum=1e3
    )


class IndirectAdaptive(OnlineEstimator):
    """
    Gradient adaptation with a Lyapunov function.

    Eq. (25): theta_hat_dot = -Gamma^-1 phi F_tilde, F_tilde = phi^T theta_hat - F, integrated
    exactly over a sample in which phi is constant. P is the covariance that this linear
    recursion gives to its own estimate: an initial spread as large as the first guess, driven by
    the force noise.

    """

    Parameters = IndirectAdaptiveParameters

    def configure(self, tuning: ParameterGroup) -> None:
        """Take new gains; see `OnlineEstimator.configure`."""
        assert isinstance(tuning, IndirectAdaptiveParameters)
        self._gain_K, self._gain_B = tuning.stiffness_gain, tuning.damping_gain
        self._rate = tuning.adaptation_rate if tuning.normalised else None

    def start_from(self, stiffness: float, damping: float) -> None:
        """Begin anew; see `OnlineEstimator.start_from`."""
        self.stiffness, self.damping = stiffness, damping
        self._seen_s = self._mean_K = self._mean_B = 0.0
        self._P_KK = stiffness**2
        self._P_KB = 0.0
        self._P_BB = max(damping**2, (1e-2 * stiffness) ** 2)

    def update(self, dt: float, row: Row, noise_variance: float, held: Held) -> None:
        """Apply eq. (25) over one sample; see `OnlineEstimator.update`."""
        y, phi_K, phi_B = row[0], row[1], row[2]
        gain_K, gain_B = (
            (self._gain_K, self._gain_B) if self._rate is None
            else self._normalised_gains(dt, phi_K, phi_B)
        )
        direction_K = 0.0 if held.stiffness else gain_K * phi_K
        direction_B = 0.0 if held.damping else gain_B * phi_B
        power = direction_K * phi_K + direction_B * phi_B  # phi^T Gamma^-1 phi [1/s]
        if power < _SMALLEST:
            return
        decay = dt * (power if self._rate is None else self._rate)
        step = -expm1(-decay) / power
        gain_K, gain_B = step * direction_K, step * direction_B
        error = y - self.stiffness * phi_K - self.damping * phi_B
        self.stiffness += gain_K * error
        self.damping += gain_B * error
        self.bound()
        self._propagate(gain_K, gain_B, phi_K, phi_B, noise_variance)

    def _normalised_gains(self, dt: float, phi_K: float, phi_B: float) -> tuple[float, float]:
        # The plain mean since the start, then over the last _MEMORY_S.
        self._seen_s = min(self._seen_s + dt, _MEMORY_S)
        share = dt / self._seen_s if self._seen_s > 0.0 else 1.0
        self._mean_K += share * (phi_K * phi_K - self._mean_K)
        self._mean_B += share * (phi_B * phi_B - self._mean_B)
        return 1.0 / (self._mean_K + _SMALLEST), 1.0 / (self._mean_B + _SMALLEST)

    def _propagate(
        self, gain_K: float, gain_B: float, phi_K: float, phi_B: float, noise_variance: float
    ) -> None:
        # P <- (I - g phi^T) P (I - g phi^T)^T + sigma^2 g g^T
        p_K = self._P_KK * phi_K + self._P_KB * phi_B
        p_B = self._P_KB * phi_K + self._P_BB * phi_B
        s = phi_K * p_K + phi_B * p_B + noise_variance
        self._P_KK += gain_K * (gain_K * s - 2.0 * p_K)
        self._P_KB += gain_K * gain_B * s - gain_K * p_B - gain_B * p_K
        self._P_BB += gain_B * (gain_B * s - 2.0 * p_B)

    @property
    def stiffness_std(self) -> float:
        """Standard deviation of K_hat [N/m]."""
        return sqrt(max(self._P_KK, 0.0))

    @property
    def damping_std(self) -> float:
        """Standard deviation of B_hat [N s/m]."""
        return sqrt(max(self._P_BB, 0.0))
