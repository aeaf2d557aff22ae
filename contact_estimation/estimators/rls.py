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

"""Recursive least squares on the bilinear form, eqs. (28) to (39)."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan, sqrt

from ..parameters import ParameterGroup, parameter
from ..signals.relations import Row, TustinRelation
from .estimator import Held, OnlineEstimator


@dataclass(frozen=True)
class RecursiveLeastSquaresParameters(ParameterGroup):
    """Start and forgetting of eqs. (36) to (38)."""

    forgetting_factor: float = parameter(
        0.98, 'lambda per sample; nearer to 1: smoother, slower', minimum=0.5, maximum=1.0
    )
    initial_covariance: float = parameter(
        1e5, 'Diagonal of P[0] in the coordinates A, B, C of eq. (31)', minimum=1e-12
    )
    estimate_inertia: bool = parameter(True, 'Estimate M_e too; false: M_e = 0')
    maximum_relative_std: float = parameter(
        0.1,
        'A parameter is not forgotten while its standard deviation exceeds this share of it, '
        'which stops the covariance from winding up', minimum=1e-4,
    )


class RecursiveLeastSquares(OnlineEstimator):
    """
    Least squares with exponential forgetting for (K_e, B_e, M_e).

    Eqs. (36) to (38) in the coordinates (K_e, B_e, M_e), related to (A, B, C) by the constant
    matrix of eq. (39): the same estimates, in numbers of readable size. Written out in scalars,
    since three-by-three array calls would cost ten times as much.

    A held parameter has neither gain nor forgetting, so that its covariance neither shrinks nor
    winds up; its uncertainty still weighs on the others (Schmidt's consider filter).

    """

    Parameters = RecursiveLeastSquaresParameters
    relation = TustinRelation

    def configure(self, tuning: ParameterGroup) -> None:
        """Take new tuning; see `OnlineEstimator.configure`."""
        assert isinstance(tuning, RecursiveLeastSquaresParameters)
        self._p = tuning
        self._lambda = tuning.forgetting_factor

    def start_from(self, stiffness: float, damping: float) -> None:
        """Begin anew with P[0] of eq. (38); see `OnlineEstimator.start_from`."""
        self.stiffness, self.damping = stiffness, damping
        self._M = 0.0
        self.inertia = 0.0 if self._p.estimate_inertia else nan
        self._P = initial_covariance(self._p.initial_covariance, self.sample_period_s)
        self._noise_variance = 0.0

    def update(self, dt: float, row: Row, noise_variance: float, held: Held) -> None:
        """Apply eqs. (36) to (38); see `OnlineEstimator.update`."""
        self._noise_variance = noise_variance
        y, f_K, f_B, f_M = row[0], row[1], row[2], row[4]
        error = y - self.stiffness * f_K - self.damping * f_B - self._M * f_M
        free_M = self._p.estimate_inertia and not (held.stiffness or held.damping)
        KK, KB, KM, BB, BM, MM = self._P
        p_K = KK * f_K + KB * f_B + KM * f_M
        p_B = KB * f_K + BB * f_B + BM * f_M
        p_M = KM * f_K + BM * f_B + MM * f_M
        s = self._lambda + f_K * p_K + f_B * p_B + f_M * p_M
        # A held parameter does not move, whatever its covariance with the others.
        l_K = 0.0 if held.stiffness else p_K / s
        l_B = 0.0 if held.damping else p_B / s
        l_M = p_M / s if free_M else 0.0
        self.stiffness += l_K * error
        self.damping += l_B * error
        if free_M:
            self._M += l_M * error
            self.inertia = self._M
        self._P = (
            KK - l_K * p_K, KB - l_K * p_B, KM - l_K * p_M,
            BB - l_B * p_B, BM - l_B * p_M, MM - l_M * p_M,
        )  # fmt: skip
        self._keep_within_limits()
        self._forget(held, free_M)

    def _keep_within_limits(self) -> None:
        """Project onto a limit along the covariance: cutting B alone would tear it off K."""
        KK, KB, _, BB, _, _ = self._P
        if self.damping < 0.0 and BB > 0.0:
            self.stiffness -= KB / BB * self.damping
            self.damping = 0.0
        limits = self.environment
        if self.stiffness < limits.minimum_stiffness and KK > 0.0:
            self.damping += KB / KK * (limits.minimum_stiffness - self.stiffness)
        self.bound()

    def _forget(self, held: Held, free_M: bool) -> None:
        KK, KB, KM, BB, BM, MM = self._P
        floor = self.environment
        variance, share = self._noise_variance, self._p.maximum_relative_std
        known_K = variance * KK < (share * max(self.stiffness, floor.minimum_stiffness)) ** 2
        known_B = variance * BB < (share * max(self.damping, floor.initial_damping)) ** 2
        # Scaling P on both sides with factors >= 1 keeps it positive definite.
        g = 1.0 / sqrt(self._lambda)
        K = g if known_K and not held.stiffness else 1.0
        B = g if known_B and not held.damping else 1.0
        M = g if known_K and known_B and free_M else 1.0
        self._P = (KK * K * K, KB * K * B, KM * K * M, BB * B * B, BM * B * M, MM * M * M)

    @property
    def stiffness_std(self) -> float:
        """Standard deviation of K_hat [N/m]; see `_std`."""
        return self._std(self._P[0])

    @property
    def damping_std(self) -> float:
        """Standard deviation of B_hat [N s/m]; see `_std`."""
        return self._std(self._P[3])

    def _std(self, entry: float) -> float:
        # sigma^2 P belongs to lambda = 1; weights lambda^i average over fewer samples:
        # sum lambda^2i / sum lambda^i = 1 / (1 + lambda) in the steady state.
        averaging = 1.0 if self._lambda == 1.0 else 1.0 / (1.0 + self._lambda)
        return sqrt(max(self._noise_variance * entry * averaging, 0.0))


def initial_covariance(
    gamma: float, sample_period_s: float
) -> tuple[float, float, float, float, float, float]:
    """
    Bring P[0] = gamma I of (A, B, C) into the coordinates (K_e, B_e, M_e).

    J gamma I J^T with J of eq. (39), times 16, since the relation is divided by 4.

    Parameters
    ----------
    gamma : float
        Diagonal of P[0] in (A, B, C).
    sample_period_s : float
        T [s].

    Returns
    -------
    P : tuple of float
        Upper triangle (KK, KB, KM, BB, BM, MM).

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
