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

"""
The lag of the force against the motion, from both in contact.

A lag tau of the force turns K d + B v into K d(t - tau) + B v(t - tau), to first order a damping
B - K tau. A line of force over position and rate is fitted with the motion shifted by many lags;
the lag with the least residual is the skew, where no other physics explains the residual as well.

"""

from __future__ import annotations

from math import log, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .check import Array, Evidence

_LONGEST_S = 0.1
_COARSE = np.linspace(-0.1, 0.1, 21)
_COARSE[10] = 0.0
_NEAREST = _COARSE[9:12]
_FINE = np.linspace(-0.01, 0.01, 21)
_MEAN_S = 0.01  # over which all signals are averaged alike
_GAP = 1.5  # times the usual duration of a mean: longer ones miss samples
_LEAST_CONTACT = 100  # samples
_LEAST_MEANS = 20
_WHITE = 1.05  # variance of the residual over the white noise's: above, a lag may be in it
_NEIGHBOUR = 20.0  # likelihood ratio of a lag of 10 ms over none, from which one is searched too
_NO_LAG_S = 5e-4  # half of the finest step


class Skew(NamedTuple):
    """
    The lag at which the force fits the motion best.

    Attributes
    ----------
    seconds : float
        Positive if the wrench comes late.
    gain : float
        Likelihood ratio over no lag, N log(r_0 / r), chi-squared of one without a lag.
    over_mass, over_physics : float
        The same over a mass that moves with the wall, and over the best other explanation.
    mass : float
        Of that explanation [kg], at least 0.
    excess_gone : float
        Share of the residual's power above the noise that the lag takes away.
    sharpness : float
        Likelihood ratio over lags of 10 ms more and less.

    """

    seconds: float
    gain: float
    over_mass: float
    over_physics: float
    mass: float
    excess_gone: float
    sharpness: float


class _Means(NamedTuple):
    """
    Means over the same short times.

    Attributes
    ----------
    size : int
        Samples in each.
    y, t, acceleration : ndarray, shape (M,)
        Pressing force without the inertia of a known mass [N], time [s], acceleration [m/s^2], of
        means in contact that share no sample.
    motion_t, motion : ndarray, shape (N,)
        Time and, as parts of complex numbers for a single search, position and rate, of the mean
        around every sample.

    """

    size: int
    y: Array
    t: Array
    acceleration: Array
    motion_t: Array
    motion: NDArray[np.complex128]


def skew_of(seen: Evidence) -> Skew | None:
    """
    Estimate the lag of the force.

    Parameters
    ----------
    seen : Evidence
        The last seconds.

    Returns
    -------
    skew : Skew or None
        None where there is too little contact.

    """
    if not seen.contact.any():
        return None
    means = _means(seen)
    if len(means.y) < _LEAST_MEANS or len(means.y) * means.size < _LEAST_CONTACT:
        return None
    y, t = means.y, means.t
    floor = max(seen.pipeline.noise_std, 1e-9)**2 / means.size * len(y)
    white = seen.white_noise**2 / means.size * len(y)
    before, none, after = _residuals(means, _NEAREST).tolist()
    sharpness = len(y) * log(min(before, after) / max(none, 1e-3 * floor))
    best, near = 0.0, np.array([none])
    if none > _WHITE * white or sharpness < -_NEIGHBOUR:
        best, near = _searched(means)
    if abs(best) < _NO_LAG_S:
        return Skew(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, sharpness)
    least = max(float(near.min()), 1e-3 * floor)
    x, v = np.interp(t, means.motion_t, means.motion.real), np.interp(
        t, means.motion_t, means.motion.imag)
    mass, with_mass = _mass(y, x, v, means.acceleration)

    def over(other: float) -> float:
        return len(y) * log(max(other, least) / least)

    return Skew(
        best, over(none), over(with_mass), over(_left_with_physics(y, x, v)), mass,
        (none - least) / max(none - floor, 1e-3 * floor), over(float(near[[0, -1]].min())),
    )


def _means(seen: Evidence) -> _Means:
    """
    Average force, motion and acceleration over the same short times.

    Means of the same samples obey the same equation, so that an impact or a noisy acceleration
    leaves nothing that looks like a lag.
    """
    size = max(1, round(_MEAN_S / max(seen.period, 1e-9)))
    moving = [_moving_mean(values, size) for values in (seen.t, seen.x, seen.rate)]
    starts = np.arange(0, len(seen.t) - size + 1, size)  # no sample twice: independent noise
    acceleration = np.gradient(seen.rate, seen.t)
    y = -seen.force - _known_mass(seen) * acceleration
    # In contact by the force alone: the location of the wall may be wrong.
    pressed = seen.contact & (seen.force < -4.0 * seen.noise)
    t = moving[0][starts]
    duration = seen.t[starts + size - 1] - seen.t[starts]
    usable = ((duration <= _GAP * (size - 1) * seen.period) & _of_blocks(pressed, size).all(1)
              & (t > seen.t[0] + _LONGEST_S) & (t < seen.t[-1] - _LONGEST_S))
    return _Means(
        size, _of_blocks(y, size).mean(1)[usable], t[usable],
        _of_blocks(acceleration, size).mean(1)[usable], moving[0], moving[1] + 1j * moving[2])


def _moving_mean(values: Array, size: int) -> Array:
    """Return the mean of every `size` successive values, of shape (N - size + 1,)."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray((sums[size:] - sums[:-size]) / size)


def _of_blocks(values: NDArray[Any], size: int) -> NDArray[Any]:
    """Return successive values in rows of `size`, without the rest."""
    return values[:len(values) // size * size].reshape(-1, size)


def _searched(means: _Means) -> tuple[float, Array]:
    """Return the best lag [s], and what the lags up to 10 ms from the best coarse one leave."""
    fine = _COARSE[np.argmin(_residuals(means, _COARSE))] + _FINE  # of 4 ms: around none
    near = _residuals(means, fine)
    return float(fine[np.argmin(near)]), near


def _known_mass(seen: Evidence) -> float:
    """Return the mass of the tool beyond the sensor, whose inertia is compensated [kg]."""
    mass = float(seen.parameters.physics.tool_inertia.mass)
    return mass if mass == mass else 0.0


def _residuals(means: _Means, lags: Array) -> Array:
    """Return the sum of squares that K x + B v + c leaves at each lag, with B >= 0."""
    y = means.y
    moved = np.interp((means.t - lags[:, None]).ravel(), means.motion_t, means.motion)
    x, v = moved.real.reshape(len(lags), -1), moved.imag.reshape(len(lags), -1)  # (lags, N)
    # Without their means no constant is needed.
    x, v, y = x - x.mean(1)[:, None], v - v.mean(1)[:, None], y - y.mean()
    xx, xv, vv = (np.einsum('ln,ln->l', a, b) for a, b in ((x, x), (x, v), (v, v)))
    xy, vy, yy = x @ y, v @ y, float(y @ y)
    xx = np.maximum(xx, 1e-300)
    alone = yy - xy * xy / xx
    rest_v, rest_y = np.maximum(vv - xv * xv / xx, 1e-300), vy - xv * xy / xx
    return np.maximum(alone - np.where(rest_y > 0.0, rest_y**2 / rest_v, 0.0), 1e-12 * yy)


def _mass(y: Array, x: Array, v: Array, a: Array) -> tuple[float, float]:
    """Return mass [kg] and sum of squares of K x + B v + M a + c with M >= 0 and no lag."""
    ones = np.ones(len(y))
    theta, left = _solve(y, x, v, ones, a)
    return (float(theta[3]), left) if theta[3] >= 0.0 else (0.0, _solve(y, x, v, ones)[1])


def _left_with_physics(y: Array, x: Array, v: Array) -> float:
    """Return the least sum of squares with one more term of other physics and no lag."""
    depth = x - x.min()
    fast = v / (np.abs(v) + 0.05 * sqrt(float(np.mean(v**2))) + 1e-12)
    ones = np.ones(len(y))
    return min(_solve(y, x, v, ones, term)[1] for term in (fast, depth**2, depth * v))


def _solve(y: Array, *columns: Array) -> tuple[Array, float]:
    """Fit by normal equations; columns of any scale."""
    table = np.stack(columns, 1)
    scale = np.sqrt(np.mean(table**2, 0)) + 1e-15
    table = table / scale
    square = table.T @ table + 1e-12 * len(y) * np.eye(len(columns))
    theta = np.linalg.solve(square, table.T @ y)
    rest = y - table @ theta
    return theta / scale, float(rest @ rest)
