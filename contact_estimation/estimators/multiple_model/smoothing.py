# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Smoothed columns of all laws from raw samples.

One smooth kernel and its analytic derivatives act on force and depth alike, so that the relation
between them stays exact, also across the touch, where y = max(x - x0, 0) has a corner, and white
noise of the force keeps its variance in the sums.
"""

from math import inf, isfinite, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from .laws import (
    ACCELERATION, ACCELERATION_NOISE, Array, COLUMNS, CUBE, CUBE_RATE, DEPTH, FORCE, FORCE_RATE,
    NOISE, OF_RATE, ONE, POWER, POWER_CURVE, POWER_DAMPING, POWER_RATE, POWER_SLOPE, RATE,
    RATE_NOISE, SET, SIGN, SQUARE, SQUARE_RATE, TIMES_RATE)

_HALF_S = 0.010  # half width of the kernel: motion up to about 30 Hz passes
_LEAST_HALF = 3  # samples
_HOP_S = 0.004  # between windows: the standard deviation of the kernel, so that little is lost
_SHARP = 3.2e-4  # deviation of a normal distribution whose sign is like tanh(v / 0.4 mm/s)
_LEAST_ROOT = 0.3  # of the greatest depth: nearer to the touch a series in the shift is none
_MOVES = 4.0  # times its noise, from which a mean square rate, or a mean, is motion


class Smoothing:
    """
    The kernel for one sample period, on windows that are a few samples apart.

    (1 - u^2)^3 on |u| < 1 with its first and second derivative, normalised so that polynomials up
    to the second degree are differentiated exactly.

    period_s: of the samples [s]
    of_s: period whose windows are used [s]: another one of the same samples; the same by default
    half, hop: samples on each side of the centre, and between the centres of windows
    noise, rate_noise, bend_noise: variance of S0, S1 and S2 of white noise of variance 1 [-],
    [1/s^2], [1/s^4]
    """

    def __init__(self, period_s: float, of_s: float = 0.0) -> None:
        self.period_s, self.of_s = period_s, of_s or period_s
        self.half = h = max(_LEAST_HALF, round(_HALF_S / self.of_s))
        self.hop = max(1, round(_HOP_S / self.of_s))
        u, t = np.arange(-h, h + 1) / (h + 1.0), np.arange(-h, h + 1) * period_s
        mean, first, second = (1 - u * u) ** 3, u * (1 - u * u) ** 2, (1 - u * u) * (5 * u * u - 1)
        second = second - second.mean()
        self._kernels = np.stack([
            mean / mean.sum(), first / (first @ t), second / (0.5 * second @ (t * t))])
        self._variance_s2 = float(self._kernels[0] @ (t * t))  # of time within the kernel
        self.noise, self.rate_noise, self.bend_noise = np.square(self._kernels).sum(1).tolist()
        self._bands: dict[int, tuple[Array, Array, NDArray[np.bool_]]] = {}

    def length(self, windows: int) -> int:
        """Return the number of samples that so many windows cover."""
        return (windows - 1) * self.hop + 2 * self.half + 1

    def bands(self, windows: int) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Return S0, S1 and S2 side by side, S0, and which samples a window covers."""
        if windows not in self._bands:
            width = 2 * self.half + 1
            table = np.zeros((3, self.length(windows), windows))
            for k in range(windows):
                table[:, k * self.hop:k * self.hop + width, k] = self._kernels
            self._bands[windows] = np.hstack(list(table)), table[0], table[0] > 0.0
        return self._bands[windows]

    def rows(
        self, force: Array, x: Array, v: Array, x0: float, noise: tuple[float, float],
        touching: bool = False, bent: Array | None = None, deepest: float = -inf,
    ) -> Array:
        """
        Return the rows of successive samples.

        force, x, v (length(N),): pressing force [N], position [m] and its measured rate, NaN
        without [m/s]
        x0: reference of the depth [m]
        noise: variance of position [m^2] and measured rate [m^2/s^2]
        touching: whether the tool is outside the wall in some of the samples
        deepest: greatest position before [m]
        bent (2, length(N)): as of `WallPosterior.take`; None where no known physics bend the wall
        Returns phi (22, N): the columns of `laws`, a row for each window
        """
        phi, inside = self._of_positions(force, x - x0, touching, deepest - x0)
        windows = phi.shape[1]
        table, mean, _ = self.bands(windows)
        phi[NOISE] = sqrt(noise[0] * self.noise)
        if bent is not None and bent.any():
            phi[RATE:ACCELERATION + 1] += (bent[0] @ table).reshape(3, windows)[1:]
            phi[ONE] += bent[1] @ mean
        rate_noise, bend_noise = noise[0] * self.rate_noise, noise[0] * self.bend_noise
        if not touching and isfinite(v @ v):
            of_v = (v @ table).reshape(3, windows)
            phi[RATE], rate_noise = _fused(
                phi[RATE], rate_noise, of_v[0], noise[1] * self.noise)
            phi[ACCELERATION], bend_noise = _fused(
                phi[ACCELERATION], bend_noise, of_v[1], noise[1] * self.rate_noise)
        if phi[RATE] @ phi[RATE] / windows < _MOVES * rate_noise:
            # The noise of a rate would bias what it multiplies; all windows together have less.
            middle = float(phi[RATE].mean())
            both = table[:, windows:2 * windows].mean(axis=1)
            rate_noise *= float(both @ both) / self.rate_noise
            if middle * middle < _MOVES * rate_noise:
                middle = rate_noise = 0.0
            phi[ACCELERATION] = bend_noise = 0.0
            phi[OF_RATE] = middle * phi[TIMES_RATE]
        # E[sgn v] of a rate with noise that changes within the window; erf is like tanh.
        within = self._variance_s2 * np.square(phi[ACCELERATION])
        width = np.sqrt(0.5 * pi * (rate_noise + _SHARP * _SHARP + within))
        phi[SIGN] = np.tanh(phi[RATE] / width) * ((inside > 0.0) @ mean)
        phi[RATE_NOISE], phi[ACCELERATION_NOISE] = sqrt(rate_noise), sqrt(bend_noise)
        phi[NOISE:, ::2] *= -1.0  # of either sign, so that no other column has them
        return phi

    def _of_positions(
        self, force: Array, y: Array, touching: bool, deepest: float
    ) -> tuple[Array, Array]:
        """Return the columns (22, N) but those of noise, of depths y (N,), and y inside."""
        windows = (len(y) - 2 * self.half - 1) // self.hop + 1
        table, mean, _ = self.bands(windows)
        inside = np.maximum(y, 0.0)
        if touching:
            y = inside
        root = np.sqrt(inside)
        power, square = inside * root, y * y
        smooth = (np.concatenate([
            y, 0.5 * square, power, power * inside / 2.5, 1.5 * root,
            0.75 / np.maximum(root, _LEAST_ROOT * root.max() + 1e-9), square * y / 3.0, force,
        ]).reshape(8, -1) @ table).reshape(8, 3, windows)
        phi = np.zeros((COLUMNS, windows))
        phi[ONE] = (y > 0.0) @ mean if touching else 1.0
        phi[DEPTH:ACCELERATION + 1] = smooth[0]
        phi[SQUARE] = 2.0 * smooth[1, 0]
        phi[SQUARE_RATE] = smooth[1, 1]
        phi[POWER:POWER_RATE + 1] = smooth[2, :2]
        phi[POWER_DAMPING] = smooth[3, 1]
        phi[POWER_SLOPE] = smooth[4, 0]
        phi[POWER_CURVE] = smooth[5, 0]
        phi[CUBE], phi[CUBE_RATE] = 3.0 * smooth[6, 0], smooth[6, 1]
        phi[SET] = -(np.maximum.accumulate(np.maximum(y, deepest)) @ mean)
        phi[FORCE:FORCE_RATE + 1] = smooth[7, :2]
        return phi, inside


def _fused(rate: Array, own: float, measured: Array, least: float) -> tuple[Array, float]:
    """Weigh a rate of the positions and the measured one by the variance of each."""
    usual = own * (1.0 + 4.0 / sqrt(len(rate)))  # two deviations of what overlapping windows show
    off = float(np.add.reduce(np.square(measured - rate))) / len(rate)
    other = max(off - usual, least, 1e-20)
    return (other * rate + own * measured) / (other + own), other * own / (other + own)
