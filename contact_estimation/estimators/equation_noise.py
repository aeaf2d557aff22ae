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

"""Noise of the equation that an estimator fits: force, position and unmodelled effects."""

from __future__ import annotations

from math import nan, sqrt

import numpy as np
from numpy.typing import NDArray

from .estimator import Frozen, OnlineEstimator, ParameterEstimate
from .excitation_monitor import Window

_LEAST_SAMPLES = 20.0  # degrees of freedom below which the residual is not used
_LEAST_SIGNAL = 0.1  # of the noise: keeps the bias finite where there is noise alone
_SMALLEST = 1e-12  # relative variance below which a column depends on the others


def residual_variance(
    products: NDArray[np.float64], effective_samples: float, with_location: bool
) -> float | None:
    """
    Estimate the noise of y = phi^T theta from the residual of its least-squares fit.

    The fit is that of the window, so that a wrong estimate does not count as noise. Filters
    reduce the variance of the rows to a share; the effective number of samples is the sum of
    these shares, and each fitted parameter reduces the degrees of freedom by one.

    Parameters
    ----------
    products : ndarray, shape (5, 5)
        Sum of row^T row, rows (y, phi_K, phi_B, phi_c, phi_M).
    effective_samples : float
        Sum over the rows of the share of white noise that is left in them.
    with_location : bool
        Whether the location, and with it an offset of the equation, is estimated.

    Returns
    -------
    variance : float or None
        Of white noise before the filter that explains the residual [N^2]; None where the
        window is too short.

    """
    fitted = [k for k in (1, 2, 3, 4) if products[k, k] > 0.0 and (k != 3 or with_location)]
    freedom = effective_samples - len(fitted)
    if freedom < _LEAST_SAMPLES:
        return None
    # Elimination column by column leaves the residual sum of squares.
    left = [[float(products[i, j]) for j in (0, *fitted)] for i in (0, *fitted)]
    for k in range(1, len(left)):
        pivot = left[k][k]
        if pivot <= _SMALLEST * products[fitted[k - 1], fitted[k - 1]]:
            continue
        for i in (0, *range(k + 1, len(left))):
            share = left[i][k] / pivot
            left[i] = [a - share * b for a, b in zip(left[i], left[k])]
    return max(left[0][0], 0.0) / freedom


class EquationNoise:
    """
    Present noise of the equation, and the systematic errors of the estimates.

    The force noise in free flight and the position noise, which a stiff wall turns into force,
    are known; the residual of the window shows the rest. The residual alone is not sufficient: a
    constant error of a position at rest is fitted as stiffness. Before there is a residual, the
    noise is at least as large as configured: a sensor that reads exactly 0 out of contact would
    make the first rows appear exact.

    Parameters
    ----------
    prior_variance : float
        Of the force noise as configured [N^2].

    """

    def __init__(self, prior_variance: float = 0.0) -> None:
        self.variance = self._prior_variance = prior_variance
        self._shares = 0.0, 0.0  # of the window: of K_hat by an offset, of B_hat by rate noise
        self._offset_share = self._rate_share = 0.0  # of what has been learned
        self.forget_updates()

    def forget_updates(self) -> None:
        """Note that a new estimator has started: no parameter has been updated yet."""
        self._stiffness_updated = self._damping_updated = False

    def note_update(self, frozen: Frozen) -> None:
        """
        Note which parameters are being updated.

        Parameters
        ----------
        frozen : Frozen
            Parameters that are not updated.

        """
        if not frozen.stiffness:
            self._stiffness_updated, self._offset_share = True, self._shares[0]
        if not frozen.damping:
            self._damping_updated, self._rate_share = True, self._shares[1]

    def judge(
        self, window: Window, force_variance: float, position_noise: float,
        estimator: OnlineEstimator,
    ) -> None:
        """
        Estimate the noise and the systematic errors from the rows of the window.

        Parameters
        ----------
        window : Window
            Of the excitation monitor.
        force_variance : float
            Of the force noise in free flight [N^2].
        position_noise : float
            Standard deviation of the position [m], quantisation included.
        estimator : OnlineEstimator
            The estimator that fits the equation.

        """
        effective_samples, rate_noise, products = window
        K, with_location = estimator.stiffness, bool(estimator.location_std)
        residual = residual_variance(products, effective_samples, with_location)
        if residual is None:
            residual = self._prior_variance
        self.variance = max(force_variance + (K * position_noise) ** 2, residual)
        # d K_hat / K_hat of a reading that is off by position_noise throughout the window
        # (quantisation at rest); where the location is estimated, this is part of its prior.
        KK, Kc = float(products[1, 1]), float(products[1, 3])
        offset_share = 0.0 if with_location or KK <= 0.0 else position_noise * Kc / KK
        rate_share = 0.0
        if estimator.biased_by_position_noise and KK > 0.0:
            # Errors in variables: least squares divides by the power of signal and noise.
            power = float(products[2, 2] - products[1, 2] ** 2 / KK)
            noise = position_noise**2 * rate_noise
            rate_share = noise / max(power - noise, _LEAST_SIGNAL * noise, 1e-30)
        self._shares = offset_share, rate_share

    def widen(self, estimate: ParameterEstimate) -> ParameterEstimate:
        """
        Return an estimate with systematic errors added to its standard deviations.

        Parameters
        ----------
        estimate : ParameterEstimate
            With the standard deviations of white equation noise.

        Returns
        -------
        widened : ParameterEstimate
            Includes a constant position error and the bias by noise of the differentiated
            position; NaN for a parameter not updated yet, which still is the initial value.

        """
        K, B, K_std, B_std, shift, inertia = estimate
        offset, bias = self._offset_share * K, self._rate_share * B
        return ParameterEstimate(
            K, B,
            sqrt(K_std * K_std + offset * offset) if self._stiffness_updated else nan,
            sqrt(B_std * B_std + bias * bias) if self._damping_updated else nan,
            shift, inertia,
        )
