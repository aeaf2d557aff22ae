# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What changes slowly: the lag of the force sensor, the speed of the surface."""

from math import log, sqrt
from typing import Sequence

import numpy as np

from .constants import FADE_S, LAG_TAIL, LONGEST_LAG_S, POLES_STD, SPEED, TWO_POLES, WALK
from .laws import (
    ACCELERATION_NOISE, Array, COLUMNS, CREEPING, DEPTH, DRIFTING, FRICTION, KELVIN_VOIGT,
    LOG_PRIOR, MASS, MOVING, ONE, SIGN, TIME)


_TAU: Array = np.linspace(0.0, LONGEST_LAG_S, 61)
_UNKNOWN = 1e30  # variance of a coefficient of which nothing is known
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

    def learn(self, weights: Array, theta: Array, P: Array) -> None:
        """
        Use a fit of K, B' and M' to all contacts of a wall, if a spring and a damper are all.

        weights (N, M): of each law with each surface
        theta, P (N M, 6), (N M, 6, 6): coefficients and covariance of each
        """
        if weights[KELVIN_VOIGT].sum() <= 0.5:
            return
        k = MASS * weights.shape[1] + int(np.argmax(weights[KELVIN_VOIGT]))
        (K, B, M), P = theta[k, :3], P[k]
        error = M + (B + K * _TAU) * _TAU - TWO_POLES * K * _TAU ** 2
        variance = _CORRELATED * (P[2, 2] + _TAU * (2.0 * P[1, 2] + _TAU * P[1, 1]))
        variance = variance + (POLES_STD * K * _TAU ** 2) ** 2 + (_ELSE * K) ** 2
        self._set(self._prior - 0.5 * (error * error / variance + np.log(variance / variance[0])))


def lag_prior(tau: float, timing_std: float) -> tuple[float, float]:
    """
    Return the prior of the lag.

    tau: lag that is compensated already [s]; NaN: none
    timing_std: `synchronisation.timing_std` [s]
    Returns mean, std: of what is left [s]
    """
    return (0.0, 0.1 * timing_std) if tau == tau else (1.2 * timing_std, timing_std)


class OwnData:
    """
    The Gram matrix of a law for which the data are not what they are for all others.

    law: index of NAMES
    gram (22, 22): of all blocks
    gained: log odds to be added to its evidence
    """

    def __init__(self, law: int) -> None:
        self.law, self.gram, self.gained = law, np.zeros((COLUMNS, COLUMNS)), 0.0

    def move(self, table: Array) -> None:
        """Move the reference of all columns; see `shifted_table`."""
        self.gram = table @ self.gram @ table.T

    def restart(self, gram: Array, rest: float) -> None:
        """Let it begin now, with the data of all others; log odds of the wall at rest."""
        self.gram, self.gained = gram.copy(), 0.0


class DoubtedRows(OwnData):
    """
    Data of a law that is less sure of some rows than others are.

    What friction is at a rate of unknown sign is noise, and so is that of the acceleration times
    a mass; under these laws alone.

    coefficient: index of what the law has beside a spring and a damper
    size: of it as last judged, friction [N] or mass [kg]
    """

    def __init__(self, law: int) -> None:
        super().__init__(law)
        self.coefficient, self.size = {MASS: 2, FRICTION: 4}[law], 0.0

    def variance(self, phi: Array, noise: float) -> Array:
        """
        Return what the variance of samples has under this law alone, (N,) [N^2].

        phi (22, N): rows
        noise: variance of S0 of white noise of variance 1
        """
        if self.law == FRICTION:
            share = 1.0 - np.square(phi[SIGN])
        else:
            share = np.square(phi[ACCELERATION_NOISE]) / noise
        return np.asarray(self.size * self.size * share)

    def add(self, phi: Array, weights: Array, told: Array, fade: float, samples: float) -> None:
        """
        Add a block.

        weights, told (N,): of its rows phi, and what they are divided by under this law
        samples: independent ones in a row
        """
        self.gram = self.gram * fade + (phi * (weights / told)) @ phi.T
        self.gained = fade * self.gained - 0.5 * samples * float(
            np.add.reduce(np.log(told)))


class MovingWall(OwnData):
    """
    The Gram matrix of a wall that moves, creeps, or whose stiffness drifts, and its odds.

    A wall that moves has a speed, which is a random walk: f = K y + B y' + s + c (t + B / K) with
    c = -K v, t being 0 now. A step w of c with variance Q takes from the matrix what it tells of c
    before: the Schur complement G - g g^T / (1 / Q + g_c), g its column of c; the evidence loses
    log(1 + Q g_c) / 2. A step of s, where a wall creeps, or of the stiffness alike.

    walked: how far its surface may have come since it was at rest [m]
    """

    def __init__(self, law: int) -> None:
        super().__init__(law)
        self._rate, self._column = {
            MOVING: (SPEED, TIME), CREEPING: (WALK, ONE), DRIFTING: (WALK, DEPTH)}[law]
        self.walked = 0.0

    def add(self, gram: Array, fade: float, seconds: float, scale: float) -> None:
        """Add a block and walk for its duration [s], K being about the scale [N/m]."""
        self._pass(seconds)
        self.gram = self.gram * fade + gram
        self.gained *= fade
        if self._column == ONE:
            depth = sqrt(float(gram[DEPTH, DEPTH] / max(gram[ONE, ONE], 1e-30)))
            self.walked += self._rate * depth * sqrt(seconds)
            scale *= depth
        self._step(self._column, scale, seconds)

    def leave(self, seconds: float, scale: float) -> None:
        """Let a wall move for a time without contact [s], which may not be known."""
        if self._column == TIME:
            seconds = min(seconds, FADE_S)
            self._pass(seconds)
            self._step(TIME, scale, seconds)
            self._step(ONE, scale, seconds**3)

    def _pass(self, seconds: float) -> None:
        """Let time pass."""
        if self._column == TIME:
            self.gram[TIME] -= seconds * self.gram[ONE]
            self.gram[:, TIME] -= seconds * self.gram[:, ONE]
            self.walked += self._rate * seconds**1.5

    def _step(self, column: int, scale: float, seconds: float) -> None:
        """Let the coefficient of a column walk for a time [s]."""
        self.gained -= 0.5 * log(self._forget(column, (self._rate * scale) ** 2 * seconds))

    def _forget(self, column: int, variance: float) -> float:
        """Take what is told of a coefficient before a step; return by how much it is wider."""
        told = self.gram[column].copy()
        known = 1.0 + variance * float(told[column])
        self.gram -= (variance / known) * (told[:, None] * told)
        return known

    @property
    def prior(self) -> float:
        """Log odds to be added to its evidence."""
        return float(LOG_PRIOR[self.law]) + self.gained

    def restart(self, gram: Array, rest: float) -> None:
        """Let it begin now, from the wall at rest, whose law has some log odds."""
        super().restart(gram, rest)
        self.gram[TIME], self.gram[:, TIME] = 0.0, 0.0
        self.gained, self.walked = rest, 0.0

    def follow(self, other: 'MovingWall') -> None:
        """Let it begin now, from one that moves otherwise."""
        if other._column != TIME:
            return self.restart(other.gram, other.prior)
        super().restart(other.gram, other.prior)
        self.gained, self.walked = other.prior, other.walked
        if self._column != TIME:
            self._forget(TIME, _UNKNOWN)


def judge_walks(
    walking: Sequence[MovingWall], odds: Array, gram: Array, rest: Array
) -> float:
    """
    Begin walls that move anew where another wall is far more probable.

    odds (N,): log odds of each law
    gram (22, 22), rest (N,): data of the wall at rest, and log odds of each law of it
    Returns lead: log odds of the best that moves against the wall at rest
    """
    best = max(walking, key=lambda one: float(odds[one.law]))
    lead = float(odds[best.law] - odds[:MOVING].max())
    for one in walking:
        if odds[one.law] - odds.max() >= LOG_PRIOR[one.law]:
            continue
        if lead > 0.0:
            one.follow(best)
        else:
            one.restart(gram, float(rest[:MOVING].max()))
    return lead
