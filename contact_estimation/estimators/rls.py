# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recursive least squares on the bilinear form, eqs. (28) to (39)."""

from dataclasses import dataclass
from math import nan, sqrt
from typing import Sequence

from .estimate import Frozen, new_tuple, ParameterEstimate
from .estimator import OnlineEstimator, TimedRow, UNKNOWN_DAMPING_S
from .three_states import Covariance, grow
from ..parameters import parameter, ParameterGroup
from ..signals.relations import TustinRelation


@dataclass(frozen=True)
class RecursiveLeastSquaresParameters(ParameterGroup):
    """Start and forgetting of eqs. (36) to (38)."""

    forgetting_factor: float = parameter(
        0.98, 'lambda per sample; nearer to 1: smoother, slower', minimum=0.5, maximum=1.0)
    initial_covariance: float = parameter(
        1e10,
        'Diagonal of P[0] in the coordinates A, B, C of eq. (31). The 1e5 of the paper is a '
        'narrow prior of B_e and M_e: the standard deviations of a first touch are far too small',
        minimum=1e-12, maximum=1e20)
    estimate_inertia: bool = parameter(True, 'Estimate M_e too; false: M_e = 0')
    maximum_relative_std: float = parameter(
        0.1,
        'A parameter is not forgotten while its standard deviation exceeds this share of it, '
        'which prevents covariance wind-up', minimum=1e-4)


class RecursiveLeastSquares(OnlineEstimator):
    """
    Least squares with exponential forgetting for (K_e, B_e, M_e).

    Eqs. (36) to (38) in the coordinates (K_e, B_e, M_e), related to (A, B, C) by the constant
    matrix of eq. (39): the same estimates, in physical units. Written out in scalars, since
    three-by-three array operations take ten times as long.

    A frozen parameter is a consider parameter (Schmidt): it has neither gain nor forgetting, so
    that its covariance neither shrinks nor winds up, but its uncertainty enters the others.
    """

    Parameters = RecursiveLeastSquaresParameters
    relation = TustinRelation

    def configure(self, tuning: ParameterGroup) -> None:
        """Set new tuning; see `OnlineEstimator.configure`."""
        assert isinstance(tuning, RecursiveLeastSquaresParameters)
        self._p = tuning
        self._lambda = tuning.forgetting_factor
        self._grow = 1.0 / sqrt(self._lambda)
        # sigma^2 P belongs to lambda = 1; weights lambda^i average over fewer samples:
        # sum lambda^2i / sum lambda^i = 1 / (1 + lambda) in the steady state.
        self._averaging = 1.0 if self._lambda == 1.0 else 1.0 / (1.0 + self._lambda)

    def start_from(self, stiffness: float, damping: float) -> None:
        """Restart with P[0] of eq. (38); see `OnlineEstimator.start_from`."""
        self.stiffness, self.damping = stiffness, damping
        self._M = 0.0
        self._P = initial_covariance(self._p.initial_covariance, self.sample_period_s)
        self._damping_updated = False
        self._noise_variance = nan  # no row yet, so no standard deviation

    def restart(
        self, stiffness: float, damping: float, stiffness_std: float, damping_std: float
    ) -> None:
        """Restart with another prior of K_e and B_e; see `OnlineEstimator.restart`."""
        noise_variance = self._noise_variance
        self.start_from(stiffness, damping)
        if noise_variance > 0.0:
            scale, self._damping_updated = noise_variance * self._averaging, True
            KK, BB = stiffness_std**2 / scale, damping_std**2 / scale
            self._noise_variance, self._P = noise_variance, (KK, 0.0, 0.0, BB, 0.0, self._P[5])

    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """Apply eqs. (36) to (38) to each row; see `OnlineEstimator.update`."""
        self._noise_variance = noise_variance
        free_K, free_B = not frozen.stiffness, not frozen.damping
        free_M = self._p.estimate_inertia and free_K and free_B
        forget, averaged = self._lambda, noise_variance * self._averaging
        K, B, M = self.stiffness, self.damping, self._M
        KK, KB, KM, BB, BM, MM = self._P
        limits = K_low, K_high, B_high = self.environment.limits
        self._damping_updated |= free_B
        unknown = 0.0
        if not self._damping_updated and noise_variance > 0.0:
            unknown = UNKNOWN_DAMPING_S**2 / noise_variance
        estimates = []
        for _, (y, f_K, f_B, _, f_M) in rows:
            if unknown * K * K > BB:  # a frozen initial value is uncertain
                BB = unknown * K * K
            (K, B, M), (KK, KB, KM, BB, BM, MM) = _corrected(
                (K, B, M), (KK, KB, KM, BB, BM, MM), (y, f_K, f_B, f_M), forget,
                (free_K, free_B, free_M))
            if not (K_low < K < K_high and 0.0 < B < B_high):
                K, B, M = _project((K, B, M), (KK, KB, KM, BB, BM), limits)
            KK, KB, KM, BB, BM, MM = self._forget(
                (KK, KB, KM, BB, BM, MM), K, B, free_K, free_B, free_M)
            estimates.append(new_tuple(ParameterEstimate, (
                K, B, sqrt(averaged * (0.0 if KK < 0.0 else KK)),
                sqrt(averaged * (0.0 if BB < 0.0 else BB)), 0.0,
                M if self._p.estimate_inertia else nan)))
        self.stiffness, self.damping, self._M = K, B, M
        self._P = KK, KB, KM, BB, BM, MM
        return estimates

    def _forget(
        self, P: Covariance, K: float, B: float, free_K: bool, free_B: bool, free_M: bool
    ) -> Covariance:
        """Forget the parameters that are neither frozen nor poorly known (wind-up)."""
        KK, KB, KM, BB, BM, MM = P
        variance, share, g = self._noise_variance, self._p.maximum_relative_std, self._grow
        least = self.environment.initial_damping
        limit_K, limit_B = share * K, share * (B if B > least else least)
        known_K = free_K and variance * KK < limit_K * limit_K
        known_B = free_B and variance * BB < limit_B * limit_B
        if known_K and known_B:  # the usual case of `grow`
            g_M = g if free_M else 1.0
            return (KK * g * g, KB * g * g, KM * g * g_M, BB * g * g, BM * g * g_M, MM * g_M * g_M)
        return grow(P, (g if known_K else 1.0, g if known_B else 1.0, 1.0))

    def current(self) -> ParameterEstimate:
        """Return the present estimate; see `OnlineEstimator.current`."""
        averaged = self._noise_variance * self._averaging
        return ParameterEstimate(
            self.stiffness, self.damping, sqrt(averaged * max(self._P[0], 0.0)),
            sqrt(averaged * max(self._P[3], 0.0)), 0.0,
            self._M if self._p.estimate_inertia else nan)


def _corrected(
    theta: tuple[float, float, float], P: Covariance, row: tuple[float, float, float, float],
    forget: float, free: tuple[bool, bool, bool],
) -> tuple[tuple[float, float, float], Covariance]:
    """Apply eqs. (36) and (37) to the parameters that are free: theta and P."""
    (K, B, M), (KK, KB, KM, BB, BM, MM), (y, f_K, f_B, f_M) = theta, P, row
    free_K, free_B, free_M = free
    p_K = KK * f_K + KB * f_B + KM * f_M
    p_B = KB * f_K + BB * f_B + BM * f_M
    p_M = KM * f_K + BM * f_B + MM * f_M
    s = forget + f_K * p_K + f_B * p_B + f_M * p_M
    error = y - K * f_K - B * f_B - M * f_M
    if free_K:
        l_K = p_K / s
        K += l_K * error
        KK -= l_K * p_K
        KB -= l_K * p_B
        KM -= l_K * p_M
    elif free_B:  # K is frozen: its covariance with B still shrinks
        KB -= p_B / s * p_K
    if free_B:
        l_B = p_B / s
        B += l_B * error
        BB -= l_B * p_B
        BM -= l_B * p_M
    if free_M:
        l_M = p_M / s
        M += l_M * error
        MM -= l_M * p_M
    return (K, B, M), (KK, KB, KM, BB, BM, MM)


def _project(
    theta: tuple[float, float, float], P: tuple[float, float, float, float, float],
    limits: tuple[float, float, float],
) -> tuple[float, float, float]:
    """Project onto a limit along the covariance, so that K, B and M move consistently."""
    K, B, M = theta
    KK, KB, KM, BB, BM = P
    K_low, K_high, B_high = limits
    if B < 0.0 and BB > 0.0:
        K, M, B = K - KB / BB * B, M - BM / BB * B, 0.0
    if K < K_low and KK > 0.0:
        excess = (K_low - K) / KK
        B, M = B + KB * excess, M + KM * excess
    return min(max(K, K_low), K_high), min(max(B, 0.0), B_high), M


def initial_covariance(
    gamma: float, sample_period_s: float
) -> tuple[float, float, float, float, float, float]:
    """
    Transform P[0] = gamma I from (A, B, C) to the coordinates (K_e, B_e, M_e).

    J gamma I J^T with J of eq. (39), times 16, since the relation is divided by 4.

    gamma: diagonal of P[0] in (A, B, C)
    sample_period_s: t [s]
    """
    T = sample_period_s
    rows = (
        (0.25, 0.25, 0.25),  # K_e = (A + B + C) / 4
        (T / 4.0, 0.0, -T / 4.0),  # B_e = T (A - C) / 4
        (T * T / 16.0, -T * T / 16.0, T * T / 16.0),  # M_e = T^2 (A - B + C) / 16
    )

    def entry(i: int, j: int) -> float:
        return 16.0 * gamma * sum(a * b for a, b in zip(rows[i], rows[j]))

    return entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)
