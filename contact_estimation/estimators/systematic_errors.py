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

"""Errors of the estimates that are not noise: timing, a wrong model, a wall not yet followed."""

from __future__ import annotations

from math import isfinite, nan, sqrt
from typing import NamedTuple, Sequence

import numpy as np

from .estimator import Frozen, OnlineEstimator, ParameterEstimate, UNKNOWN_DAMPING_S
from .excitation_monitor import Window
from ..signals.relations import TustinRelation

_LEAST_BLOCKS = 2  # beyond the fitted parameters, for the scatter of the blocks
_SMOOTHING = 0.2  # per judgement, of the correlation: ten blocks determine it poorly
_FADING = 0.97  # per judgement, of the spread of depths from which B was learned
_AGREES = 3.0  # standard deviations by which estimate and window may differ
_EXPLAINED = 2.0  # times the known noise: a larger residual is an error of the model
_ABSORBED = 2.0  # of such an error in a regressor, relative to what is left: friction in a sine
_WIDEST = 10.0  # standard deviation of a B_e of which nothing is known, relative to its prior
_RIDGE = 1e-10  # relative; keeps the fit finite without motion
_LOCATION, _MASS = 3, 4  # columns of a row
_TREND = 5  # column of K_e times time, behind them
_SMALLEST = 1e-24  # power of a column relative to that of phi_B, in SI units


class WindowFit(NamedTuple):
    """
    Least squares over the window.

    Attributes
    ----------
    values : tuple of float
        K [N/m] and B [N s/m].
    variances : tuple of float
        Of both, for white noise of variance 1 before the filter.
    scatter : tuple of float
        Of both, from the scatter of the blocks: right for correlated residuals too. NaN where
        there are too few blocks.
    by_acceleration : float
        Change of K for a force m a that is not fitted, per m.

    """

    values: tuple[float, float]
    variances: tuple[float, float]
    scatter: tuple[float, float]
    by_acceleration: float


class _Sums:
    """
    Products of the rows of each block, with a column phi_K t for a trend of K_e.

    Parameters
    ----------
    blocks : sequence of Window
        The blocks of the window, the last one the newest.

    """

    def __init__(self, blocks: Sequence[Window]) -> None:
        count = len(blocks)
        raw = np.array([block.products for block in blocks])  # (n, 5, 5)
        time = np.arange(1.0 - count, 1.0) / count  # 0 at the end of the window
        products = np.empty((count, _TREND + 1, _TREND + 1))
        products[:, :_TREND, :_TREND] = raw
        products[:, _TREND, :_TREND] = products[:, :_TREND, _TREND] = time[:, None] * raw[:, 1]
        products[:, _TREND, _TREND] = time * time * raw[:, 1, 1]
        total = products.sum(axis=0)
        self.powers: list[float] = total.diagonal().tolist()
        self.scale = np.array([1.0, *(1.0 / sqrt(p) if p > _SMALLEST else 0.0
                                      for p in self.powers[1:])])
        both = self.scale * self.scale[:, None]
        self._blocks, self._total = products * both, total * both

    def fit(
        self, fitted: list[int], location_information: float, by_parts: bool
    ) -> WindowFit:
        """
        Fit columns, with the covariance of correlated residuals.

        With s_b = sum of phi r over block b, the covariance is A^-1 (sum s_b s_b^T) A^-1,
        A = sum phi phi^T (cluster-robust; Liang and Zeger 1986): no assumption about the
        residuals within a block.

        Parameters
        ----------
        fitted : sequence of int
            Columns, those of K and B first.
        location_information : float
            Of the prior, on the column of the location.
        by_parts : bool
            Whether the window holds no acceleration.

        Returns
        -------
        fit : WindowFit
            With K at the end of the window where its trend is fitted.

        """
        A = self._total[fitted][:, fitted]
        A.flat[::len(fitted) + 1] += _RIDGE
        if _LOCATION in fitted:
            index = fitted.index(_LOCATION)
            A[index, index] += location_information * self.scale[_LOCATION] ** 2
        inverse = np.linalg.inv(A)
        theta = inverse @ self._total[fitted, 0]  # in units of the scales
        weights = np.zeros(_TREND + 1)
        weights[0], weights[fitted] = 1.0, -theta
        scores = (self._blocks @ weights)[:, fitted]  # (n, p)
        freedom = len(scores) - len(fitted)
        correction = len(scores) / freedom if freedom >= _LEAST_BLOCKS else nan
        K_spread, B_spread = ((inverse[:2] @ scores.T) ** 2).sum(axis=1).tolist()
        K_scale, B_scale = self.scale[1:3].tolist()
        K_power, B_power = K_scale * K_scale, B_scale * B_scale
        K_left, B_left = float(inverse[0, 0]) * K_power, float(inverse[1, 1]) * B_power
        # sum of d a = -sum of v v, by parts, where no mass is fitted
        lacking = -self.powers[2] * K_left if by_parts else 0.0
        return WindowFit(
            (float(theta[0]) * K_scale, float(theta[1]) * B_scale), (K_left, B_left),
            (K_spread * K_power * correction, B_spread * B_power * correction), lacking,
        )


def fit_window(
    blocks: Sequence[Window], noise_variance: float, estimator: OnlineEstimator
) -> tuple[WindowFit, ...]:
    """
    Fit the window as the estimator does, with a trend of K_e, and with the location.

    Parameters
    ----------
    blocks : sequence of Window
        The blocks of the window.
    noise_variance : float
        Of the equation, which weighs the prior of the location [N^2].
    estimator : OnlineEstimator
        Whose parameters are fitted.

    Returns
    -------
    fits : tuple of WindowFit
        As the estimator; at the end of the window; with x_e free, unless the estimator does so.
        The first alone where the blocks are too few, none where the window holds no motion.

    """
    sums = _Sums(blocks)
    if sums.powers[1] <= _SMALLEST or sums.powers[2] <= _SMALLEST:
        return ()
    location_std = estimator.location_std
    has_mass = sums.powers[_MASS] > _SMALLEST
    fitted = [1, 2, *([_LOCATION] if location_std else []), *([_MASS] if has_mass else [])]
    information = 0.0
    if location_std:
        information = noise_variance / _square(estimator.stiffness * location_std)
    by_parts = not issubclass(estimator.relation, TustinRelation)
    mean = sums.fit(fitted, information, by_parts)
    if len(blocks) < len(fitted) + 1 + _LEAST_BLOCKS:
        return (mean,)
    end = sums.fit([*fitted, _TREND], information, by_parts)
    if location_std:
        return mean, end
    return mean, end, sums.fit([*fitted, _LOCATION], 0.0, by_parts)


def _by_shift(blocks: Sequence[Window]) -> float:
    """Return the relative change of K_hat per shift of the surface [1/m]."""
    first, power = (sum(float(block.products[1, k]) for block in blocks) for k in (_LOCATION, 1))
    return first / power if power > 0.0 else 0.0


def _depth_spread(blocks: Sequence[Window]) -> float:
    """Return the standard deviation of phi_K over the window, relative to its mean."""
    power, first, count = (sum(float(block.products[i, j]) for block in blocks)
                           for i, j in ((1, 1), (1, _LOCATION), (_LOCATION, _LOCATION)))
    return sqrt(max(power * count / (first * first) - 1.0, 0.0)) if first > 0.0 else 0.0


class _Shares(NamedTuple):
    """Of one parameter: factor of its variance, and variance beside it."""

    factor: float
    variance: float


class SystematicErrors:
    """
    Add to the deviations of any estimator what its own covariance does not contain.

    - A lag of the force that is not compensated acts as damping -K tau, and as mass -B tau, which
      moves K where no mass is fitted. Its standard deviation is `timing_std`.
    - Correlated residuals: the variance from the scatter of the blocks of the window, relative to
      that of white noise, multiplies that of the estimator.
    - An estimate that differs from a fit of the window by more than both allow has not followed
      the wall, or x_e is wrong; the difference is its error.
    - Where the law damps with depth, B_hat is a secant, different at the depths where it was
      learned.
    - A residual beyond the known noise is an error of the model. It may have any shape, that of
      a regressor included, so that it does not average out.

    Parameters
    ----------
    timing_std : float
        Of the time between force and motion [s].

    """

    def __init__(self, timing_std: float) -> None:
        self.timing_std = timing_std
        self._correlations = [[1.0, 1.0] for _ in range(3)]  # by fit
        self._spread = 0.0
        self._now = self._learned = _Shares(1.0, 0.0), _Shares(1.0, 0.0)

    def judge(
        self, blocks: Sequence[Window], noise_variance: float, known_variance: float,
        position_noise: float, location_std: float, estimator: OnlineEstimator,
    ) -> None:
        """
        Compare an estimator with the last window.

        Parameters
        ----------
        blocks : sequence of Window
            The blocks of the window.
        noise_variance : float
            Of the equation, from its residual [N^2].
        known_variance : float
            Of force and position noise [N^2].
        position_noise : float
            Standard deviation of the position [m].
        location_std : float
            Standard deviation of x_e, where it has been found from this contact [m].
        estimator : OnlineEstimator
            The estimator.

        """
        fits = fit_window(blocks, noise_variance, estimator)
        if not fits:
            return
        excess = max(noise_variance - _EXPLAINED**2 * known_variance, 0.0)
        excess *= _ABSORBED**2 * sum(block.effective_samples for block in blocks)
        rate_noise = position_noise**2 * sum(block.rate_noise for block in blocks)
        lag = estimator.damping * self.timing_std
        K_lag = lag * fits[0].by_acceleration
        self._note_correlations(fits, noise_variance)
        moved = estimator.stiffness * location_std * _by_shift(blocks)
        K_error, B_error = self._differences(fits, noise_variance, rate_noise, lag, estimator)
        of_K, of_B = (excess * variance for variance in fits[0].variances)
        B_error += UNKNOWN_DAMPING_S**2 * K_error  # B was fitted beside a wrong K
        if not estimator.fits_linear_damping:
            self._spread = max(_depth_spread(blocks), _FADING * self._spread)
            B_error += _square(estimator.damping * self._spread)
        widest = _WIDEST * max(estimator.damping, UNKNOWN_DAMPING_S * estimator.stiffness)
        of_B = min(of_B, widest * widest)  # a tool at rest shows no damping
        K_error += of_K + K_lag * K_lag + moved * moved
        K_correlation, B_correlation = self._correlations[0]
        self._now = (_Shares(max(K_correlation, 1.0), K_error),
                     _Shares(max(B_correlation, 1.0), B_error + of_B))

    def _note_correlations(self, fits: Sequence[WindowFit], noise_variance: float) -> None:
        for fit, correlation in zip(fits, self._correlations):
            for k in (0, 1):
                if isfinite(fit.scatter[k]):
                    white = max(noise_variance * fit.variances[k], 1e-300)
                    correlation[k] += _SMOOTHING * (fit.scatter[k] / white - correlation[k])

    def _differences(
        self, fits: Sequence[WindowFit], noise_variance: float, rate_noise: float, lag: float,
        estimator: OnlineEstimator,
    ) -> tuple[float, float]:
        """Return the squares of what K_hat and B_hat differ from the window beyond chance."""
        K, B = estimator.stiffness, estimator.damping
        of_K, of_B = 0.0, 0.0
        first = min(1, len(fits) - 1)
        for fit, correlation in zip(fits[first:], self._correlations[first:]):
            white_K, white_B = (noise_variance * max(c, 1.0) * variance
                                for c, variance in zip(correlation, fit.variances))
            share = min(rate_noise * fit.variances[1], 0.5)  # of the power of phi_B
            bias = fit.values[1] * share / (1.0 - share)
            moved = lag * fit.by_acceleration
            of_K = max(of_K, _square(fit.values[0] - K)
                       - _AGREES**2 * (white_K + _square(moved)))
            of_B = max(of_B, _square(fit.values[1] - B)
                       - _AGREES**2 * (white_B + _square(bias)))
        return of_K, of_B

    def note_update(self, frozen: Frozen) -> None:
        """
        Note which parameters are being updated; the errors of the others stay.

        Parameters
        ----------
        frozen : Frozen
            Parameters that are not updated.

        """
        K, B = self._learned
        self._learned = (K if frozen.stiffness else self._now[0],
                         B if frozen.damping else self._now[1])

    def widen(self, estimate: ParameterEstimate) -> ParameterEstimate:
        """
        Return an estimate with these errors added to its standard deviations.

        Parameters
        ----------
        estimate : ParameterEstimate
            With the standard deviations of the estimator.

        Returns
        -------
        widened : ParameterEstimate
            NaN stays NaN.

        """
        K, B, K_std, B_std, shift, inertia = estimate
        of_K, of_B = self._learned
        lag = K * self.timing_std
        return ParameterEstimate(
            K, B, sqrt(K_std * K_std * of_K.factor + of_K.variance),
            sqrt(B_std * B_std * of_B.factor + of_B.variance + lag * lag), shift, inertia,
        )


def _square(value: float) -> float:
    """Return the square; infinite, instead of an error as by **, where an estimate diverged."""
    return value * value
