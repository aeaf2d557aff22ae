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

"""Size of a window's residual beyond the noise, as pure functions."""

from __future__ import annotations

from math import ceil, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SLOWEST_SENSOR_S = 1.6e-3
"""Greatest time constant of a force sensor that is no fault of the model: 100 Hz [s]."""

EARLIEST_FORCE_S = 4e-4
"""By which the force may be stamped early, relative to the position [s]."""

_COLOURED = 2.0  # variance of noise over what second differences show, where a sensor filters it
_BELOW_95_PERCENT = 0.759  # mean of the lower 95 % of squares, of a normal variable of variance 1
_EXACT = 1e-3  # of the force: no force sensor is more linear
_SMALLEST = 1e-12  # rms of a regressor without excitation


class Window(NamedTuple):
    """
    Rows of recent contact, as arrays.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Time [s].
    rows : ndarray, shape (N, 5)
        Filtered (y, phi_K, phi_B, phi_c, phi_M).
    fitted : ndarray, shape (N, M)
        Columns that the estimator fits, as of `OnlineEstimator.columns_of`.
    raw : ndarray, shape (N, 3)
        Unfiltered F_e [N], x [m] and its rate [m/s], NaN where not measured.
    gains : ndarray, shape (N, 2)
        `NoiseGain` of each row.
    location_std : float
        By which x_e may be off; it is estimated then, or within the position noise [m].

    """

    t: Array
    rows: Array
    fitted: Array
    raw: Array
    gains: Array
    location_std: float

    @property
    def acceleration(self) -> Array:
        """Rate of phi_B, which is filtered as all columns are, shape (N,) [m/s^2]."""
        v, t = self.rows[:, 2], self.t
        slopes = (v[1:] - v[:-1]) / (t[1:] - t[:-1])
        a = np.concatenate([slopes[:1], 0.5 * (slopes[1:] + slopes[:-1]), slopes[-1:]])
        return np.asarray(a)


class Residual(NamedTuple):
    """
    What the model leaves of a window.

    Attributes
    ----------
    ratio : float
        Rms of noise and structure over that of the noise: 1 for a right model.
    values : ndarray, shape (N,)
        Residual of the filtered rows [N].

    """

    ratio: float
    values: Array


def fit(
    window: Window, noise_variance: float, position_noise: float, sample_period_s: float
) -> Residual:
    """
    Fit the model to the window and compare the residual with the noise.

    The fit is the window's own: a wrong or slow estimate does not count as a wrong model. What
    the filtered residual has beyond filtered white noise is its structure.

    Parameters
    ----------
    window : Window
        Rows of contact.
    noise_variance : float
        Of the force noise in free flight [N^2].
    position_noise : float
        Standard deviation of the position [m].
    sample_period_s : float
        Nominal T [s].

    Returns
    -------
    residual : Residual
        Size and values.

    """
    plain = window.rows[:, :3]
    products = plain.T @ plain
    K, B = _solved(products[1:, 1:], products[1:, 0], len(plain)).tolist()
    left = _residual(window, abs(K), abs(B))
    variance = _noise_variance(window, K, B, noise_variance, sample_period_s)
    share, rate = (window.gains.sum(axis=0) / len(plain)).tolist()
    noise = share * variance + position_noise**2 * (K * K + B * B * rate)
    structure = max(float(left @ left) / len(left) - noise, 0.0)
    return Residual(sqrt(1.0 + structure / variance), left)


def _residual(window: Window, K: float, B: float) -> Array:
    """
    Return what the model leaves.

    Two regressors are no fault of the model as long as their coefficients are small: the
    acceleration, since a force sensor that lags by tau adds K tau^2 - B tau times it (-K tau v is
    part of the fitted B), and a constant, since x_e may be off. What exceeds their bounds stays
    in the residual.

    """
    tau, own = SLOWEST_SENSOR_S, window.fitted.shape[1]
    off = 2.0 * K * window.location_std
    # The true B_e is at most B + K tau. A force that is early makes the mass positive.
    limits = {own + 1: (-(B + K * tau) * tau, K * tau**2 + B * EARLIEST_FORCE_S),
              own + 2: (-off, off)}
    y, columns = window.rows[:, 0], np.empty((own + 3, len(window.t))).T
    columns[:, 0], columns[:, 1:own + 1] = y, window.fitted
    columns[:, own + 1], columns[:, own + 2] = window.acceleration, window.rows[:, 3]
    products = columns.T @ columns
    b, theta, fitted = products[:, 0].copy(), np.zeros(own + 3), list(range(1, own + 3))
    while True:
        theta[fitted] = _solved(products[fitted][:, fitted], b[fitted], len(y))
        over = [k for k in fitted if k in limits and not limits[k][0] <= theta[k] <= limits[k][1]]
        if not over:
            return np.asarray(y - columns[:, 1:] @ theta[1:])
        for k in over:
            theta[k] = min(max(theta[k], limits[k][0]), limits[k][1])
            b -= theta[k] * products[:, k]
            fitted.remove(k)


def least_squares(columns: Array, y: Array) -> Array:
    """
    Solve y = columns theta; directions without excitation get 0.

    Parameters
    ----------
    columns : ndarray, shape (N, M)
        Regressors.
    y : ndarray, shape (N,)
        What they explain.

    Returns
    -------
    theta : ndarray, shape (M,)
        Coefficients.

    """
    return _solved(columns.T @ columns, columns.T @ y, len(y))


def _solved(products: Array, b: Array, count: int) -> Array:
    """Solve normal equations of a number of rows; see `least_squares`."""
    if not np.isfinite(products @ b).all():
        return np.zeros(len(b))
    scale = np.sqrt(products.diagonal() / count)
    scale[scale < _SMALLEST] = np.inf
    values, vectors = np.linalg.eigh(products / (scale[:, None] * scale))
    values[values <= 1e-10 * values[-1]] = np.inf
    theta: Array = vectors @ (vectors.T @ (b / scale) / values) / scale
    return theta


def _noise_variance(
    window: Window, K: float, B: float, in_free_flight: float, sample_period_s: float
) -> float:
    """
    Return the variance of the noise that the residual is compared with.

    That of free flight is an average that begins with the configured value, so it counts only
    where the contact shows about as much. No sensor is exact: the noise is at least a thousandth
    of the force.

    """
    wide_band = _wide_band_variance(window, K, B, sample_period_s)
    y = window.rows[:, 0]
    force = float(y @ y) / len(y)
    return max(
        wide_band, min(in_free_flight, _COLOURED * wide_band), _EXACT**2 * force, _SMALLEST**2)


def _wide_band_variance(window: Window, K: float, B: float, sample_period_s: float) -> float:
    """
    Return the variance of white noise that second differences of the raw residual show.

    Position noise, quantisation and jitter of the stamps show in them, smooth motion does not.
    The largest are left out: friction makes the force jump at every reversal.

    """
    force, position, velocity = window.raw.T
    raw = force + K * position
    if velocity[0] == velocity[0]:  # measured
        raw += B * velocity
    second = raw[2:] - 2.0 * raw[1:-1] + raw[:-2]
    squares = second[window.t[2:] - window.t[:-2] < 2.5 * sample_period_s] ** 2
    squares = squares[squares == squares]
    if not len(squares):
        return 0.0
    most = ceil(0.95 * len(squares))
    lower = np.partition(squares, most - 1)[:most]
    return float(np.mean(lower)) / (6.0 * _BELOW_95_PERCENT)
