# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recursive least squares with a forgetting factor that adapts to the prediction error."""

from dataclasses import dataclass
from math import exp, nan, sqrt
from typing import Sequence

from .estimate import Frozen, new_tuple, ParameterEstimate
from .estimator import OnlineEstimator, TimedRow
from .three_states import constrain, correct, diagonal, grow, State
from ..parameters import parameter, ParameterGroup
from ..signals.relations import TustinRelation

_SMALLEST = 1e-18


@dataclass(frozen=True)
class AdaptiveLeastSquaresParameters(ParameterGroup):
    """Start and forgetting."""

    smallest_forgetting_factor: float = parameter(
        0.9, 'Lower limit of lambda per sample', minimum=0.5, maximum=1.0)
    memory_samples: float = parameter(
        300.0,
        'Number of rows averaged while their errors stay within the noise; larger: smoother, '
        'slower to detect a change', minimum=2.0, maximum=1e9)
    stiffness_std: float = parameter(
        1e5, 'Prior standard deviation of K_e', 'N/m', minimum=1e-3, maximum=1e12)
    damping_std: float = parameter(
        1e4, 'Prior standard deviation of B_e', 'N s/m', minimum=1e-3, maximum=1e12)
    inertia_std: float = parameter(
        10.0, 'Prior standard deviation of M_e; 0: M_e = 0', 'kg', minimum=0.0, maximum=1e6)
    maximum_relative_std: float = parameter(
        0.1,
        'A parameter is not forgotten while its standard deviation exceeds this share of it, '
        'which prevents covariance wind-up', minimum=1e-4)


class AdaptiveLeastSquares(OnlineEstimator):
    """
    Eqs. (36) to (38) on the bilinear form with a variable forgetting factor.

    lambda = 1 - e^2 / (s sigma^2 N), with e the a priori error and s sigma^2 its expected square,
    keeps the information of N rows (Fortescue, Kershenbaum and Ydstie 1981). Rows without error
    or without excitation are hardly forgotten; a change of the wall is followed within a few
    rows. Directional forgetting and constant trace were noisier or slower on the same data.

    P is the covariance itself, in (K_e, B_e, M_e). Frozen or poorly known parameters are not
    forgotten; frozen ones enter as consider parameters (Schmidt), as in `rls`.
    """

    Parameters = AdaptiveLeastSquaresParameters
    relation = TustinRelation

    def configure(self, tuning: ParameterGroup) -> None:
        """Set new tuning; see `OnlineEstimator.configure`."""
        assert isinstance(tuning, AdaptiveLeastSquaresParameters)
        self._p = tuning
        self._noise_growth = exp(1.0 / tuning.memory_samples)

    def start_from(self, stiffness: float, damping: float) -> None:
        """Restart with the prior; see `OnlineEstimator.start_from`."""
        p = self._p
        self.stiffness, self.damping = stiffness, damping
        self._variance = 0.0
        self._x: State = stiffness, damping, 0.0
        self._P = diagonal(p.stiffness_std, p.damping_std, p.inertia_std)

    def restart(
        self, stiffness: float, damping: float, stiffness_std: float, damping_std: float
    ) -> None:
        """Restart with another prior of K_e and B_e; see `OnlineEstimator.restart`."""
        self.stiffness, self.damping = stiffness, damping
        self._x = stiffness, damping, 0.0
        self._P = diagonal(stiffness_std, damping_std, self._p.inertia_std)

    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """Update, then forget, for each row; see `OnlineEstimator.update`."""
        free_K, free_B = not frozen.stiffness, not frozen.damping
        free_M = free_K and free_B and self._p.inertia_std > 0.0
        free = free_K, free_B, free_M
        K_low, K_high, B_high = self.environment.limits
        estimates = []
        for _, (y, f_K, f_B, _, f_M) in rows:
            variance = self._renewed_variance(noise_variance)
            K, B, M = self._x
            error = y - K * f_K - B * f_B - M * f_M
            self._x, self._P, expected = correct(
                self._x, self._P, (f_K, f_B, f_M), error, variance, free)
            K, B, _ = self._x
            if K_low <= K <= K_high and 0.0 <= B <= B_high:
                self.stiffness, self.damping = K, B
            else:
                self._project()
            surprise = error * error / (expected * self._p.memory_samples)
            self._forget(1.0 - surprise, *free)
            estimates.append(self.current())
        return estimates

    def _renewed_variance(self, noise_variance: float) -> float:
        """
        Return the noise variance for the next row.

        A sudden change of the wall raises the residual too: the noise variance may grow by a
        factor e per `memory_samples` rows at most.
        """
        slow = self._variance * self._noise_growth or noise_variance
        variance = slow if slow < noise_variance else noise_variance
        self._variance = variance = variance if variance > _SMALLEST else _SMALLEST
        return variance

    def _forget(self, factor: float, free_K: bool, free_B: bool, free_M: bool) -> None:
        """Forget the parameters that are excited and known."""
        p, (KK, KB, KM, BB, BM, MM) = self._p, self._P
        limit_K = p.maximum_relative_std * self.stiffness
        B, least = self.damping, self.environment.initial_damping
        limit_B = p.maximum_relative_std * (B if B > least else least)
        known_K = free_K and KK < limit_K * limit_K
        known_B = free_B and BB < limit_B * limit_B
        if not known_K and not known_B:
            return
        least = p.smallest_forgetting_factor
        g = 1.0 / sqrt(factor if factor > least else least)
        g_M = g if free_M and known_K and known_B else 1.0
        if known_K and known_B:  # the usual case of `grow`
            self._P = (KK * g * g, KB * g * g, KM * g * g_M, BB * g * g, BM * g * g_M,
                       MM * g_M * g_M)
        else:
            self._P = grow(self._P, (g if known_K else 1.0, g if known_B else 1.0, g_M))

    def _project(self) -> None:
        """Project onto a limit along the covariance, so that the others move consistently."""
        K_low, K_high, B_high = self.environment.limits
        x = constrain(self._x, self._P, (0.0, 1.0, 0.0), 0.0, B_high)
        self._x = K, B, _ = constrain(x, self._P, (1.0, 0.0, 0.0), K_low, K_high)
        self.stiffness, self.damping = self.within_limits(K, B)

    def current(self) -> ParameterEstimate:
        """Return the present estimate; see `OnlineEstimator.current`."""
        KK, _, _, BB, _, _ = self._P
        return new_tuple(ParameterEstimate, (
            self.stiffness, self.damping, sqrt(KK) if KK > 0.0 else 0.0,
            sqrt(BB) if BB > 0.0 else 0.0, 0.0, self._x[2] if self._p.inertia_std > 0.0 else nan))
