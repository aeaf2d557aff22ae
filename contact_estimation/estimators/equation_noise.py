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

import numpy as np
from numpy.typing import NDArray

from .estimator import OnlineEstimator
from .row_sums import Window

_LEAST_SAMPLES = 20.0  # degrees of freedom below which the residual is not used
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
    Present noise of the equation.

    The force noise in free flight and the position noise, which a stiff wall turns into force,
    are known; the residual of the window shows the rest. The residual alone is not sufficient: a
    constant error of a position at rest is fitted as stiffness. Before there is a residual, the
    noise is at least as large as configured: a sensor that reads exactly 0 out of contact would
    make the first rows appear exact.

    Parameters
    ----------
    prior_variance : float
        Of the force noise as configured [N^2].

    Attributes
    ----------
    variance : float
        Of the equation, as white noise before the filter [N^2].

    """

    def __init__(self, prior_variance: float = 0.0) -> None:
        self.variance = self._prior_variance = prior_variance

    def judge(
        self, window: Window, force_variance: float, position_noise: float,
        estimator: OnlineEstimator,
    ) -> None:
        """
        Estimate the noise from the rows of the window.

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
        residual = residual_variance(
            window.products, window.effective_samples, bool(estimator.location_std))
        if residual is None:
            residual = self._prior_variance
        known = force_variance + (estimator.stiffness * position_noise) ** 2
        self.variance = max(known, residual)
