# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a law leaves of the force, over the errors that samples have: weights, alarms, the fit."""

from math import inf, nan, sqrt
from typing import TypeVar

import numpy as np

from .blocks import Blocks
from .constants import JITTER_S, MODEL_ERROR, MODEL_ERROR_S
from .contact import ContactFilter
from .evidence import Scene
from .knowledge import Knowledge
from .laws import (
    Array, BENT, CHOSEN, DEPTH, EXPONENT, FORCE, FORCE_RATE, Ints, LATE, POWERS, scales, UNKNOWNS)

_ALARM = 4.0  # deviations of the median of a short block that ends a longer one
_OF_MEDIAN = 1.57  # its variance over that of a mean: pi / 2
_CLIPPED = 4.0  # times the mean so far: a change is no misfit
_RESIDUAL_S = 2.0  # over which residuals are averaged
_Force = TypeVar('_Force', float, Array)


class Residuals:
    """
    The residuals of the best hypothesis, and the variances of the samples that they are over.

    blocks, contact: the samples, and the noise of the force
    best: its law, coefficients and scene; None without one
    """

    def __init__(self, blocks: Blocks, contact: ContactFilter) -> None:
        self._blocks, self._contact = blocks, contact
        self._variance = 0.0  # of the force, as the last block began
        self._mean_square = nan
        self.best: tuple[Ints, Array, Scene] | None = None

    @property
    def fit(self) -> float:
        """Rms of the residual over that of its errors, in the last 2 s of contact; NaN before."""
        return sqrt(self._mean_square)

    @property
    def doubt(self) -> float:
        """Factor of all deviations: what no law explains lasts like the usual error of one."""
        excess = max(0.0, self._mean_square - 1.0)  # 0 where it is NaN
        return sqrt(1.0 + excess * MODEL_ERROR_S / self._blocks.period_s)

    def begin_block(self) -> None:
        """Let alarms be over the noise as it is now."""
        self._variance = self._contact.variance

    def variance_of(self, force: _Force) -> _Force:
        """Return the variance of a force: of noise, and of what no law predicts of it [N^2]."""
        error = MODEL_ERROR * force
        return self._contact.variance + error * error * (MODEL_ERROR_S / self._blocks.period_s)

    def weights(self, phi: Array, K: _Force, B: _Force, unknown: Array) -> Array:
        """
        Return samples a row over its variance: of noises, stamps, and errors of any model.

        K, B: for the noise of the position [N/m], [N s/m]
        unknown (N,): variance of what else is not known of a sample [N^2]
        """
        force, smooth = phi[FORCE], self._blocks.smoothing
        if self.best is not None:  # a curved wall is stiffer where it is deeper
            law, _, scene = self.best
            if POWERS[:, law].any():
                stiffer, damped = np.maximum(phi[DEPTH] / scene.depth, 0.0) ** POWERS[:, law]
                K, B = EXPONENT[law] * K * stiffer, B * damped
        variance = (self.variance_of(force) + unknown + np.square(JITTER_S * phi[FORCE_RATE])
                    + self._blocks.noise[0] * (K * K + B * B * smooth.rate_noise / smooth.noise))
        return np.asarray(smooth.hop / variance)

    def alarms(self, now: Knowledge, force: list[float], x: list[float]) -> bool:
        """Return whether a short block [N, m] is not what the wall as known explains."""
        if not now.valid:
            return False
        K, B, T = now.stiffness, now.damping, self._blocks.period_s
        count = len(x)
        part = -(-count // 3)
        middle, rest = part // 2, [f - K * one for f, one in zip(force, x)]
        travel = sorted(x[-part:])[middle] - sorted(x[:part])[middle]
        rate = travel / (max(count - part, 1) * T)  # medians: outliers are no part of them
        off = sorted(rest)[count // 2] - self._contact.level + K * now.surface - B * rate
        error, jitter = MODEL_ERROR * force[-1], JITTER_S * K * rate
        variance = _OF_MEDIAN / count * (
            self._variance + error * error * (MODEL_ERROR_S / T) + jitter * jitter
            + self._blocks.noise[0] * (K * K + 2.0 * count * (B / (count * T)) ** 2))
        return off * off > _ALARM * _ALARM * variance

    def surprise(self, phi: Array, weights: Array, x0: float, early: bool) -> float:
        """
        Return the mean square residual of a block, in variances of the noise, and average it.

        x0: reference of the columns [m]
        early: whether contact or wall are too new for the average
        """
        if self.best is None:
            return 0.0
        law, theta, scene = self.best
        if scene.x0 != x0:
            return inf
        columns = phi[CHOSEN[law[0], :UNKNOWNS]] * scales(law, scene.depth)[0, :UNKNOWNS, None]
        tau = scene.lag[0] if LATE[law[0]] else 0.0
        columns[4:] -= (law[0] == BENT) * columns[0]
        error = phi[FORCE] + tau * phi[FORCE_RATE] - theta @ columns
        smooth = self._blocks.smoothing
        ratio = float(np.add.reduce(error * error * weights)) / len(error) / (
            smooth.hop * smooth.noise)
        if not early:
            before = self._mean_square if self._mean_square == self._mean_square else 1.0
            share = min(phi.shape[1] * smooth.hop * self._blocks.period_s / _RESIDUAL_S, 1.0)
            self._mean_square = before + share * (min(ratio, _CLIPPED * before + 1.0) - before)
        return ratio
