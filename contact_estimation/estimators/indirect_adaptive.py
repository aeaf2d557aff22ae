# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Indirect adaptive estimation, eqs. (20) to (27) of Erickson, Weber and Sharf (2003)."""

from dataclasses import dataclass
from math import expm1, nan, sqrt
from typing import Sequence

from .estimate import Frozen, new_tuple, ParameterEstimate
from .estimator import OnlineEstimator, TimedRow, UNKNOWN_DAMPING_S
from .gradient_speed import limitation_of
from ..parameters import parameter, ParameterGroup

_SMALLEST = 1e-30
_MEMORY_S = 1.0  # of the mean squares that normalise
_REMEDY = 'set tuning.indirect_adaptive.normalised, or choose another estimator'


@dataclass(frozen=True)
class IndirectAdaptiveParameters(ParameterGroup):
    """Gains of eq. (25)."""

    stiffness_gain: float = parameter(
        5.0e4, 'Entry of Gamma^-1 for K; larger: faster, noisier', 'N/m/(N m s)', minimum=0.0)
    damping_gain: float = parameter(
        2.5e3, 'Entry of Gamma^-1 for B; larger: faster, noisier', 'N s/m/(N m)', minimum=0.0)
    normalised: bool = parameter(
        False,
        'Scale each gain by the mean square of its regressor instead: the same speed at any '
        'stiffness')
    adaptation_rate: float = parameter(
        20.0, 'Decay rate of the force error when normalised', '1/s', minimum=0.0, maximum=1e3)


class IndirectAdaptive(OnlineEstimator):
    """
    Gradient adaptation with a Lyapunov function.

    Eq. (25): theta_hat_dot = -Gamma^-1 phi F_tilde, F_tilde = phi^T theta_hat - F, integrated
    exactly over a sample in which phi is constant. P is the covariance that this linear
    recursion gives its own estimate: initially as large as the initial value, driven by the
    force noise.
    """

    Parameters = IndirectAdaptiveParameters

    def configure(self, tuning: ParameterGroup) -> None:
        """Set new gains; see `OnlineEstimator.configure`."""
        assert isinstance(tuning, IndirectAdaptiveParameters)
        self._gain_K, self._gain_B = tuning.stiffness_gain, tuning.damping_gain
        self._rate = tuning.adaptation_rate if tuning.normalised else None

    def start_from(self, stiffness: float, damping: float) -> None:
        """Restart; see `OnlineEstimator.start_from`."""
        self.stiffness, self.damping = stiffness, damping
        self._seen_s = self._mean_K = self._mean_B = 0.0
        self._damping_updated = False
        self._P = stiffness**2, 0.0, max(damping, UNKNOWN_DAMPING_S * stiffness) ** 2

    def restart(
        self, stiffness: float, damping: float, stiffness_std: float, damping_std: float
    ) -> None:
        """Restart with another P; see `OnlineEstimator.restart`."""
        self.start_from(stiffness, damping)
        self._damping_updated = True  # else its initial value would be the prior
        self._P = stiffness_std**2, 0.0, damping_std**2

    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """Apply eq. (25) over each sample; see `OnlineEstimator.update`."""
        normalised, rate = self._rate is not None, self._rate or 0.0
        gain_K = 0.0 if frozen.stiffness else self._gain_K
        gain_B = 0.0 if frozen.damping else self._gain_B
        K, B = self.stiffness, self.damping
        P_KK, P_KB, P_BB = self._P
        K_low, K_high, B_high = self.environment.limits
        self._damping_updated |= not frozen.damping
        unknown = 0.0 if self._damping_updated else UNKNOWN_DAMPING_S
        estimates = []
        for dt, row in rows:
            P_BB = max(P_BB, (unknown * K) ** 2)
            y, f_K, f_B = row[0], row[1], row[2]
            if normalised:
                gain_K, gain_B = self._normalised_gains(dt, f_K, f_B, frozen)
            g_K, g_B = gain_K * f_K, gain_B * f_B
            power = g_K * f_K + g_B * f_B  # phi^T Gamma^-1 phi [1/s]
            if power > _SMALLEST:
                step = -expm1(-dt * (rate if normalised else power)) / power
                g_K *= step
                g_B *= step
                error = y - K * f_K - B * f_B
                K += g_K * error
                B += g_B * error
                if not (K_low < K < K_high and 0.0 < B < B_high):
                    K, B = self.within_limits(K, B)
                # P <- (I - g phi^T) P (I - g phi^T)^T + sigma^2 g g^T
                p_K, p_B = P_KK * f_K + P_KB * f_B, P_KB * f_K + P_BB * f_B
                s = f_K * p_K + f_B * p_B + noise_variance
                P_KK += g_K * (g_K * s - 2.0 * p_K)
                P_KB += g_K * g_B * s - g_K * p_B - g_B * p_K
                P_BB += g_B * (g_B * s - 2.0 * p_B)
            estimates.append(new_tuple(ParameterEstimate, (
                K, B, sqrt(P_KK) if P_KK > 0.0 else 0.0, sqrt(P_BB) if P_BB > 0.0 else 0.0,
                0.0, nan)))
        self.stiffness, self.damping, self._P = K, B, (P_KK, P_KB, P_BB)
        return estimates

    def _normalised_gains(
        self, dt: float, phi_K: float, phi_B: float, frozen: Frozen
    ) -> tuple[float, float]:
        # The plain mean since the start, then over the last _MEMORY_S.
        self._seen_s = min(self._seen_s + dt, _MEMORY_S)
        share = dt / self._seen_s if self._seen_s > 0.0 else 1.0
        self._mean_K += share * (phi_K * phi_K - self._mean_K)
        self._mean_B += share * (phi_B * phi_B - self._mean_B)
        return (
            0.0 if frozen.stiffness else 1.0 / (self._mean_K + _SMALLEST),
            0.0 if frozen.damping else 1.0 / (self._mean_B + _SMALLEST))

    @property
    def limitation(self) -> str:
        """Return the walls for which the gains are too small; see `OnlineEstimator.limitation`."""
        return '' if self._rate is not None else limitation_of(self._gain_K, _REMEDY)

    def current(self) -> ParameterEstimate:
        """Return the present estimate; see `OnlineEstimator.current`."""
        P_KK, _, P_BB = self._P
        return ParameterEstimate(
            self.stiffness, self.damping, sqrt(max(P_KK, 0.0)), sqrt(max(P_BB, 0.0)), 0.0, nan)
