# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Model reference adaptive control in the structure of Singh and Popa (1995)."""

from dataclasses import dataclass
from math import nan, sqrt
from typing import Sequence

from .estimate import Frozen, new_tuple, ParameterEstimate
from .estimator import OnlineEstimator, TimedRow
from .gradient_speed import limitation_of
from .model_following import ModelFollowing, ModelFollowingParameters
from .parameters import EnvironmentParameters
from ..parameters import group, parameter, ParameterGroup
from ..reference.setpoints import Reference

Matrix = tuple[float, float, float, float]  # 2 x 2 by rows: numpy is slow on so few numbers
Symmetric = tuple[float, float, float]
_GAP_PERIODS = 2.5
"""Sample periods without a sample after which the model restarts at the arm."""


@dataclass(frozen=True)
class ModelReferenceParameters(ParameterGroup):
    """Tuning of the environment estimator and of the controller of the arm."""

    stiffness_gain: float = parameter(
        5.0e4, 'Entry of Gamma^-1 for K in eq. (25)', 'N/m/(N m s)', minimum=0.0)
    damping_gain: float = parameter(
        2.5e3, 'Entry of Gamma^-1 for B in eq. (25)', 'N s/m/(N m)', minimum=0.0)
    memory_s: float = parameter(
        1.0, 'Time over which eq. (25) is averaged; 0: eq. (25) as published, which '
        'without excitation keeps the error of B from touch-down', 's', minimum=0.0, maximum=60.0)
    control: ModelFollowingParameters = group(ModelFollowingParameters)


class ModelReferenceAdaptive(OnlineEstimator):
    """
    Control of an unknown arm to follow the target impedance, and eq. (25) for the environment.

    The arm with its unknown parameters, the reference model and the adaptation that matches the
    two are in `ModelFollowing`; its force drives a force-controlled robot. The environment
    estimator is eq. (25) averaged over the recent contact,

        theta_hat_dot = -Gamma^-1 (R theta_hat - Q),
        T_m R_dot = phi phi^T - R,    T_m Q_dot = phi F - Q

    (Kreisselmeier 1977): with the Lyapunov function of eq. (24), V_dot = -2 theta_tilde^T R
    theta_tilde, where R has full rank if both K and B were excited within the memory T_m.
    T_m = 0 is eq. (25) itself.
    """

    Parameters = ModelReferenceParameters
    follows_reference = True
    may_restart = False
    control_force = 0.0

    def __init__(
        self, tuning: ParameterGroup, environment: EnvironmentParameters, sample_period_s: float
    ) -> None:
        assert isinstance(tuning, ModelReferenceParameters)
        self.following = ModelFollowing(tuning.control)
        super().__init__(tuning, environment, sample_period_s)

    def configure(self, tuning: ParameterGroup) -> None:
        """Set new tuning; see `OnlineEstimator.configure`."""
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
        """Restart; the estimates of the arm stay. See `OnlineEstimator.start_from`."""
        self.stiffness, self.damping = stiffness, damping
        self._seen_s = 0.0
        # Upper triangles of symmetric matrices.
        self._R: Symmetric = (0.0, 0.0, 0.0)
        self._Q = 0.0, 0.0
        # Covariances: of theta_hat, of theta_hat with the noise in Q, and of that noise.
        self._P: Symmetric = (stiffness**2, 0.0, max(damping**2, (1e-2 * stiffness) ** 2))
        self._N = self._R
        self._C: Matrix = (0.0, 0.0, 0.0, 0.0)

    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """Apply the averaged eq. (25) over each sample; see `OnlineEstimator.update`."""
        gain_K = 0.0 if frozen.stiffness else self._p.stiffness_gain
        gain_B = 0.0 if frozen.damping else self._p.damping_gain
        K_low, K_high, B_high = self.environment.limits
        estimates = []
        for dt, row in rows:
            keep, share = self._shares(dt)
            f_K, f_B, y = row[1], row[2], share * row[0]
            KK, KB, BB = f_K * f_K, f_K * f_B, f_B * f_B
            a, b, d = self._R
            self._R = r_KK, r_KB, r_BB = (
                keep * a + share * KK, keep * b + share * KB, keep * d + share * BB)
            a, b = self._Q
            self._Q = q_K, q_B = keep * a + y * f_K, keep * b + y * f_B
            a, b, d = self._N
            kept, new = keep * keep, share * share * noise_variance
            self._N = kept * a + new * KK, kept * b + new * KB, kept * d + new * BB
            # (1 / dt + Gamma^-1 R)^-1 Gamma^-1: implicit Euler, stable at any gain
            g_K, g_B = dt * gain_K, dt * gain_B
            a, b, c, d = 1.0 + g_K * r_KK, g_K * r_KB, g_B * r_KB, 1.0 + g_B * r_BB
            scale = 1.0 / (a * d - b * c)
            s_KK, s_KB, s_BK, s_BB = S = (
                scale * d * g_K, -scale * b * g_B, -scale * c * g_K, scale * a * g_B)
            K, B = self.stiffness, self.damping
            e_K, e_B = r_KK * K + r_KB * B - q_K, r_KB * K + r_BB * B - q_B
            K, B = K - s_KK * e_K - s_KB * e_B, B - s_BK * e_K - s_BB * e_B
            if not (K_low < K < K_high and 0.0 < B < B_high):
                K, B = self.within_limits(K, B)
            self.stiffness, self.damping = K, B
            self._spread(S, keep)
            estimates.append(self.current())
        return estimates

    def _shares(self, dt: float) -> tuple[float, float]:
        """Return the shares of past and row in a mean since the start, then over the memory."""
        seen_s, memory_s = self._seen_s + dt, self._p.memory_s
        if seen_s > memory_s:
            seen_s = memory_s if memory_s > dt else dt
        self._seen_s = seen_s
        share = dt / seen_s if seen_s > 0.0 else 1.0
        return 1.0 - share, share

    def _spread(self, S: Matrix, keep: float) -> None:
        """Pass the covariances through theta <- A theta + S Q, A = I - S R."""
        # With C = cov(theta, Q) kept from the last sample and N = cov(Q): C <- A C + S N and
        # P <- A P A^T + A C S^T + S C^T A^T + S N S^T.
        (s, t, u, v), (r, q, w), (n, o, m) = S, self._R, self._N
        a, b, c, d = 1.0 - s * r - t * q, -s * q - t * w, -u * r - v * q, 1.0 - u * q - v * w
        e, f, g, h = self._C
        e, f, g, h = keep * e, keep * f, keep * g, keep * h
        # A C, then with S N
        i, j, k, z = a * e + b * g, a * f + b * h, c * e + d * g, c * f + d * h
        i, j = i + s * n + t * o, j + s * o + t * m
        k, z = k + u * n + v * o, z + u * o + v * m
        self._C = i, j, k, z
        p, x, y = self._P
        # P A^T + C S^T, then A times it, with S times the new C^T
        aa, ab = p * a + x * b + e * s + f * t, p * c + x * d + e * u + f * v
        ba, bb = x * a + y * b + g * s + h * t, x * c + y * d + g * u + h * v
        self._P = (a * aa + b * ba + s * i + t * j, a * ab + b * bb + s * k + t * z,
                   c * ab + d * bb + u * k + v * z)

    @property
    def limitation(self) -> str:
        """Return the walls for which the gains are too small; see `OnlineEstimator.limitation`."""
        return limitation_of(self._p.stiffness_gain)

    def current(self) -> ParameterEstimate:
        """Return the present estimate; see `OnlineEstimator.current`."""
        K_variance, _, B_variance = self._P
        return new_tuple(ParameterEstimate, (
            self.stiffness, self.damping, 0.0 if K_variance <= 0.0 else sqrt(K_variance),
            0.0 if B_variance <= 0.0 else sqrt(B_variance), 0.0, nan))
