# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The lag of the force sensor, from what it does to the second derivative."""

from __future__ import annotations

from math import sqrt

import numpy as np

from .constants import LAG_TAIL, LONGEST_LAG_S, POLES_STD, TWO_POLES
from .laws import Array

_TAU: Array = np.linspace(0.0, LONGEST_LAG_S, 61)
_CORRELATED = 4.0  # times the variance that white noise would leave
_ELSE = 2e-7  # share of K_e in the second coefficient that is no lag: 0.4 ms of one [s^2]


class LagPosterior:
    """
    The posterior of tau on a grid, shared by all contacts.

    The fit of K, B' and M' without a prior of M' obeys B' = B - K tau and
    M' = c K tau^2 - B tau, with c between 1/2 (a delay) and 1 (one pole): the larger the damping,
    the better it is seen.

    mean, std: prior of tau [s]
    lag: tau and its standard deviation [s]
    """

    def __init__(self, mean: float, std: float) -> None:
        self._prior = -0.5 * LAG_TAIL * np.log1p(np.square((_TAU - mean) / max(std, 1e-5)))
        self._set(self._prior)

    def _set(self, log_posterior: Array) -> None:
        p = np.exp(log_posterior - log_posterior.max())
        p /= p.sum()
        tau = float(p @ _TAU)
        self.lag = tau, sqrt(float(p @ np.square(_TAU - tau)) + 1e-10)

    def learn(self, theta: Array, P: Array) -> None:
        """
        Use a fit of K, B' and M' to all contacts of a wall.

        theta, P (5,), (5, 5): coefficients and covariance
        """
        K, B, M = theta[:3]
        error = M + (B + K * _TAU) * _TAU - TWO_POLES * K * _TAU ** 2
        variance = _CORRELATED * (P[2, 2] + _TAU * (2.0 * P[1, 2] + _TAU * P[1, 1]))
        variance = variance + (POLES_STD * K * _TAU ** 2) ** 2 + (_ELSE * K) ** 2
        self._set(self._prior - 0.5 * (error * error / variance + np.log(variance / variance[0])))


def told_lag(tau: float, timing_std: float) -> tuple[float, float]:
    """
    Return the prior of the lag.

    tau: lag that is compensated already [s]; NaN: none
    timing_std: `synchronisation.timing_std` [s]
    Returns mean, std: of what is left [s]
    """
    return (0.0, 0.1 * timing_std) if tau == tau else (1.2 * timing_std, timing_std)
