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

"""Recursive least squares with a forgetting factor that adapts to the prediction error."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, nan, sqrt
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .estimator import Frozen, OnlineEstimator, ParameterEstimate, TimedRow
from ..parameters.specification import parameter, ParameterGroup
from ..signals.relations import Row, TustinRelation

_SMALLEST = 1e-18


@dataclass(frozen=True)
class AdaptiveLeastSquaresParameters(ParameterGroup):
    """Start and forgetting."""

    smallest_forgetting_factor: float = parameter(
        0.9, 'Lower limit of lambda per sample', minimum=0.5, maximum=1.0
    )
    memory_samples: float = parameter(
        300.0,
        'Number of rows averaged while their errors stay within the noise; larger: smoother, '
        'slower to detect a change', minimum=2.0, maximum=1e9,
    )
    stiffness_std: float = parameter(
        1e5, 'Prior standard deviation of K_e', 'N/m', minimum=1e-3, maximum=1e12
    )
    damping_std: float = parameter(
        1e4, 'Prior standard deviation of B_e', 'N s/m', minimum=1e-3, maximum=1e12
    )
    inertia_std: float = parameter(
        10.0, 'Prior standard deviation of M_e; 0: M_e = 0', 'kg', minimum=0.0, maximum=1e6
    )
    maximum_relative_std: float = parameter(
        0.1,
        'A parameter is not forgotten while its standard deviation exceeds this share of it, '
        'which prevents covariance wind-up', minimum=1e-4,
    )


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
        self._theta = np.array([stiffness, damping, 0.0])
        self._P = np.diag([p.stiffness_std, p.damping_std, p.inertia_std]) ** 2

    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """Update, then forget, for each row; see `OnlineEstimator.update`."""
        free = np.array([
            not frozen.stiffness, not frozen.damping,
            not (frozen.stiffness or frozen.damping) and self._p.inertia_std > 0.0,
        ])
        estimates = []
        for _, row in rows:
            # A sudden change of the wall raises the residual too: the noise variance may grow by
            # a factor e per memory_samples rows at most.
            slow = self._variance * self._noise_growth or noise_variance
            self._variance = max(min(noise_variance, slow), _SMALLEST)
            self._update(row, self._variance, free)
            estimates.append(self.current())
        return estimates

    def _update(self, row: Row, variance: float, free: NDArray[np.bool_]) -> None:
        theta, P = self._theta, self._P
        phi = np.array([row[1], row[2], row[4]])
        gain = P @ phi
        expected = float(phi @ gain) + variance
        error = row[0] - float(phi @ theta)
        gain /= expected
        frozen = P[np.ix_(~free, ~free)].copy()
        self._theta = theta + gain * error * free
        P = P - np.outer(gain, phi @ P)
        P[np.ix_(~free, ~free)] = frozen
        self._P = 0.5 * (P + P.T)
        self._keep_within_limits()
        surprise = error * error / (expected * self._p.memory_samples)
        self._forget(max(1.0 - surprise, self._p.smallest_forgetting_factor), free)

    def _forget(self, factor: float, free: NDArray[np.bool_]) -> None:
        """Scale P on both sides with factors >= 1, which keeps it positive definite."""
        scales = np.array([self.stiffness, max(self.damping, self.environment.initial_damping)])
        known = np.diag(self._P)[:2] < (self._p.maximum_relative_std * scales) ** 2
        forgets = free & np.array([known[0], known[1], known[0] and known[1]])
        growth = np.where(forgets, 1.0 / sqrt(factor), 1.0)
        self._P = self._P * growth * growth[:, None]

    def _keep_within_limits(self) -> None:
        """Project onto a limit along the covariance, so that the others move consistently."""
        K_low, K_high, B_high = self.environment.limits
        for index, low, high in ((1, 0.0, B_high), (0, K_low, K_high)):
            value, variance = float(self._theta[index]), float(self._P[index, index])
            excess = value - min(max(value, low), high)
            if excess != 0.0 and variance > 0.0:
                self._theta = self._theta - self._P[:, index] * (excess / variance)
        self.stiffness, self.damping = self.within_limits(*self._theta[:2].tolist())

    def current(self) -> ParameterEstimate:
        """Return the present estimate; see `OnlineEstimator.current`."""
        K_std, B_std, _ = np.sqrt(np.maximum(np.diag(self._P), 0.0)).tolist()
        inertia = float(self._theta[2]) if self._p.inertia_std > 0.0 else nan
        return ParameterEstimate(self.stiffness, self.damping, K_std, B_std, 0.0, inertia)
