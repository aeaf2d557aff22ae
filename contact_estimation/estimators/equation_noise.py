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

"""How noisy the equation is that an estimator fits: force, position and what is not modelled."""

from __future__ import annotations

from math import nan, sqrt

import numpy as np
from numpy.typing import NDArray

from .estimator import Frozen, OnlineEstimator, ParameterEstimate
from .excitation_monitor import Window

_LEAST_SAMPLES = 20.0  # effective ones, less the parameters, before a residual is believed
_LEAST_SIGNAL = 0.1  # share of the noise: where noise is all there is, the claim stays finite
_SMALLEST = 1e-12  # relative variance of a column that is none of its own


def residual_variance(
    products: NDArray[np.float64], effective_samples: float, with_location: bool
) -> float | None:
    """
    Tell the noise of y = phi^T theta from what its least-squares fit over a window leaves.

    The fit is the window's own, so that a wrong estimate is not taken for noise. Filters shrink
    the variance of the rows to a share; the effective number of samples is that share summed,
    and each fitted parameter costs one of them.

    Parameters
    ----------
    products : ndarray, shape (5, 5)
        Sum of row^T row, rows (y, phi_K, phi_B, phi_c, phi_M).
    effective_samples : float
        Sum over the rows of the share of white noise that is left in them.
    with_location : bool
        Whether the equation has an offset K_e times the wall's shift.

    Returns
    -------
    variance : float or None
        Of white noise before the filter that would leave as much [N^2]; None where the window
        is too short to tell.

    """
    fitted = [k for k in (1, 2, 3, 4) if products[k, k] > 0.0 and (k != 3 or with_location)]
    freedom = effective_samples - len(fitted)
    if freedom < _LEAST_SAMPLES:
        return None
    # Elimination column by column leaves y^T y less what the columns explain.
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
    Noise of the equation at present, and what may be claimed of the estimates in face of it.

    Known beforehand is the force noise of free flight and the position noise, which a stiff wall
    turns into force; the residual shows the rest. The residual alone would not do: the reading
    of a position that stands still is off by a constant, which a fit takes for stiffness. Before
    there is a residual, the noise is not taken for less than configured: a sensor that reads
    exactly 0 out of contact would make the first rows look exact.

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
        """Note that an estimator begins anew: it has learned nothing yet."""
        self._stiffness_learned = self._damping_learned = False

    def note_update(self, frozen: Frozen) -> None:
        """
        Note which parameters learn now.

        Parameters
        ----------
        frozen : Frozen
            Those that do not.

        """
        if not frozen.stiffness:
            self._stiffness_learned, self._offset_share = True, self._shares[0]
        if not frozen.damping:
            self._damping_learned, self._rate_share = True, self._shares[1]

    def judge(
        self, window: Window, force_variance: float, position_noise: float,
        estimator: OnlineEstimator,
    ) -> None:
        """
        Take the window's rows into account.

        Parameters
        ----------
        window : Window
            The rows of the last moments.
        force_variance : float
            Of the force noise in free flight [N^2].
        position_noise : float
            Standard deviation of the position [m], quantisation included.
        estimator : OnlineEstimator
            Whose equation it is.

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

    def widen(self, known: ParameterEstimate) -> ParameterEstimate:
        """
        Say of an estimate only what the data support.

        Parameters
        ----------
        known : ParameterEstimate
            With the standard deviations of white equation noise.

        Returns
        -------
        claimed : ParameterEstimate
            With those of a constant position error and of noise in the differentiated position as
            well; NaN for what was frozen from the
            start, which is the first guess and nothing else.

        """
        K, B, K_std, B_std, shift, inertia = known
        offset, bias = self._offset_share * K, self._rate_share * B
        return ParameterEstimate(
            K, B,
            sqrt(K_std * K_std + offset * offset) if self._stiffness_learned else nan,
            sqrt(B_std * B_std + bias * bias) if self._damping_learned else nan,
            shift, inertia,
        )
