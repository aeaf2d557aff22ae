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

"""Least squares over the blocks of a window, with the scatter of its blocks."""

from __future__ import annotations

from math import inf, nan, sqrt
from typing import NamedTuple, Sequence

import numpy as np

from .estimator import OnlineEstimator
from .row_sums import LARGEST, Window
from ..signals.relations import TustinRelation

_LEAST_BLOCKS = 2  # beyond the fitted parameters, for the scatter of the blocks
_RIDGE = 1e-10  # relative; keeps the fit finite without motion
_DAMPING, _LOCATION, _MASS = 2, 3, 4  # columns of a row
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
        Of both, for white noise of variance 1 before the filter; infinite for B of a tool at rest.
    scatter : tuple of float
        Of both, from the scatter of the blocks: right for correlated residuals too. NaN where
        there are too few blocks, and for B of a tool at rest.
    by_acceleration : float
        Change of K for a force m a that is not fitted, per m.

    """

    values: tuple[float, float]
    variances: tuple[float, float]
    scatter: tuple[float, float]
    by_acceleration: float


class WindowFits(NamedTuple):
    """
    Fits of one window.

    Attributes
    ----------
    mean : WindowFit
        With the parameters of the estimator.
    end : WindowFit or None
        With a trend of K_e, at the end of the window; None where the blocks are too few.
    located : WindowFit or None
        With x_e free; None where the estimator fits it.

    """

    mean: WindowFit
    end: WindowFit | None
    located: WindowFit | None


class _Sums:
    """
    Products of the rows of each block, with a column phi_K t for a trend of K_e.

    Columns are scaled to a power of 1 over the window.

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

    def fits(
        self, columns: Sequence[Sequence[int]], information: float, by_parts: bool
    ) -> tuple[WindowFit, ...]:
        """
        Fit several choices of columns, with the covariance of correlated residuals.

        With s_b = sum of phi r over block b, the covariance is A^-1 (sum s_b s_b^T) A^-1,
        A = sum phi phi^T (cluster-robust; Liang and Zeger 1986): no assumption about the
        residuals within a block.

        Parameters
        ----------
        columns : sequence of sequence of int
            Of each fit, that of K among them.
        information : float
            Of the prior of the location.
        by_parts : bool
            Whether the window holds no acceleration.

        Returns
        -------
        fits : tuple of WindowFit
            With K at the end of the window where its trend is fitted.

        """
        used = np.zeros((len(columns), _TREND + 1))
        for mask, chosen in zip(used, columns):
            mask[list(chosen)] = 1.0
        A = self._total * (used[:, :, None] * used[:, None, :])  # columns not fitted: identity
        diagonal = np.einsum('kii->ki', A)
        diagonal += 1.0 - used + _RIDGE
        diagonal[:, _LOCATION] += information * self.scale[_LOCATION] ** 2
        inverse = np.linalg.inv(A[:, 1:, 1:])  # (k, 5, 5)
        theta = (inverse @ (self._total[1:, 0] * used[:, 1:])[:, :, None])[:, :, 0]
        weights = np.ones((_TREND + 1, len(columns)))
        weights[1:] = -theta.T
        scores = (self._blocks @ weights)[:, 1:] * used[:, 1:].T  # (n, 5, k)
        spread = ((inverse[:, :2] @ scores.transpose(2, 1, 0)) ** 2).sum(axis=2)  # (k, 2)
        unit = self.scale[1:3]
        return tuple(
            self._fit(values, variances, scatter, chosen, by_parts)
            for values, variances, scatter, chosen in zip(
                (theta[:, :2] * unit).tolist(),
                (inverse[:, (0, 1), (0, 1)] * unit**2).tolist(),
                (spread * unit**2).tolist(), columns)
        )

    def _fit(
        self, values: list[float], variances: list[float], scatter: list[float],
        fitted: Sequence[int], by_parts: bool,
    ) -> WindowFit:
        count = len(self._blocks)
        freedom = count - len(fitted)
        correction = count / freedom if freedom >= _LEAST_BLOCKS else nan
        # sum of d a = -sum of v v, by parts, where no mass is fitted
        lacking = -self.powers[2] * variances[0] if by_parts else 0.0
        moves = _DAMPING in fitted
        return WindowFit(
            (values[0], values[1]), (variances[0], variances[1] if moves else inf),
            (scatter[0] * correction, scatter[1] * correction if moves else nan), lacking)


def fit_window(
    blocks: Sequence[Window], noise_variance: float, estimator: OnlineEstimator
) -> WindowFits | None:
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
    fits : WindowFits or None
        None where the wall is not pressed, or sums are too large for squares of them.

    """
    sums = _Sums(blocks)
    if sums.powers[1] <= _SMALLEST or not all(power < LARGEST for power in sums.powers):
        return None
    location_std = estimator.location_std
    shown = [column for column in (_DAMPING, _MASS) if sums.powers[column] > _SMALLEST]
    fitted = [1, *shown, *([_LOCATION] if location_std else [])]
    information = 0.0
    if location_std:
        scale = estimator.stiffness * location_std
        information = noise_variance / (scale * scale)
    columns = [fitted, [*fitted, _TREND], *([] if location_std else [[*fitted, _LOCATION]])]
    by_parts = not issubclass(estimator.relation, TustinRelation)
    mean, end, *located = sums.fits(columns, information, by_parts)
    long = len(blocks) >= len(fitted) + 1 + _LEAST_BLOCKS
    return WindowFits(mean, end if long else None, located[0] if located else None)
