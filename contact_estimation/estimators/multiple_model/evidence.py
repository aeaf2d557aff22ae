# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The marginal likelihood of hypotheses on Gram matrices, and what each says of the wall."""

from math import inf
from typing import Generator, NamedTuple, Sequence

import numpy as np

from .constants import NEAR_DEPTH, NOISE_DOUBT, UNLIKELY
from .laws import (
    ACCELERATION, ACCELERATION_NOISE, Array, BENT, CHOSEN, COLUMNS, CURVED, DEPTH, EXPONENT,
    FORCE_RATE, FRICTION, Ints, LATE, MASS, NOISE, OF_DEPTH, OF_RATE, ONE, prior, RATE, RATE_NOISE,
    scales, TIMES_RATE, UNKNOWNS, YIELDING)

_DIAGONAL = np.arange(UNKNOWNS)
_TIMES: Ints = np.array([dict(zip(OF_RATE, TIMES_RATE))[column] for column in CHOSEN[:, 1]])
_FLAT: Ints = (COLUMNS * CHOSEN[:, :, None] + CHOSEN[:, None, :]).reshape(len(CHOSEN), -1)
_EXPLAIN: Ints = np.array([ONE, DEPTH, RATE])
_EXPLAINED = np.arange(len(_EXPLAIN))
_SOFTEST = 1e-2  # scale of the priors [N/m]
_DOUBT = 3.0  # times the stiffness so far: the prior of the next
_WIDE = 1e4  # at least [N/m]
_CLEAN = 0.9999  # reliability of a depth without noise
_RIDGE = 1e-10  # of a unit diagonal, so that columns that are the same leave no singular matrix


class Scene(NamedTuple):
    """What all hypotheses share."""

    # x0, depth: reference of the columns and mean penetration [m]
    x0: float
    depth: float
    damping: float  # B_e / K_e as estimated so far [s]
    lag: tuple[float, float]  # of the force sensor, and its standard deviation [s]
    level: float = 0.0  # variance of the force of free flight as known [N^2]


class Hypotheses(NamedTuple):
    """Laws, each with a prior of its stiffness and its surface."""

    law: Ints  # (N,) indices of NAMES
    stiffness: Array  # (N,) scale of the priors [N/m]
    # centre, std (N,): of the surface [m]
    centre: Array
    std: Array


class Place(NamedTuple):
    """Where a surface may be."""

    # centre, std: x_e and its standard deviation [m]
    centre: float
    std: float
    probability: float
    unfelt: float = 0.0  # force that the wall may have there already, as felt by a touch [N]
    # told, told_std: prior that a touch is combined with [m]
    told: float = 0.0
    told_std: float = inf


def hypotheses(
    laws: Ints, surfaces: Sequence[Place], scale: float, depth: float
) -> Hypotheses:
    """
    Return each law with each surface.

    scale: of the priors of K_e [N/m]
    depth: at which it is K_e [m]: K y^n is a force at depth (force / (K_e depth))^(1/n)
    """
    centre, std, _, unfelt, told, told_std = np.tile(np.array(surfaces).T, len(laws))
    law = np.repeat(laws, len(surfaces))
    within = np.minimum(unfelt / (scale * depth), 1.0) ** (1.0 / EXPONENT[law])
    variance = std * std + np.square(depth * within)
    share = 1.0 / (1.0 + variance / np.square(told_std))
    return Hypotheses(law, np.full(len(centre), scale), told + share * (centre - told),
                      np.sqrt(share * variance))


class Judged(NamedTuple):
    """The posterior of the coefficients under each hypothesis."""

    # (N,) log marginal likelihood, up to what all hypotheses on the same data share
    evidence: Array
    theta: Array  # (N, 6) means
    P: Array  # (N, 6, 6) covariances


class _Normal(NamedTuple):
    """Normal equations of hypotheses."""

    # scaled, unit (N, 6, 6), (N, 6): A = G + L with a diagonal of 1, and what it was multiplied by
    # on both sides
    scaled: Array
    unit: Array
    # eta, std (N, 6): information vectors, and the deviations of the priors
    eta: Array
    std: Array
    squares: Array  # (N,) f^T f + m^T L m
    blur: Array  # (N, 3) what the noise of the position may add to the information of K, B, M


def judge(grams: Array, scene: Scene, what: Hypotheses) -> Judged:
    """
    Fit hypotheses to data.

    With the Gram matrix G of the columns weighted by the noise, a Gaussian prior of precision L
    and mean m, and A = G + L, eta = G_f + L m:

        theta = A^-1 eta,  P = A^-1
        2 log p(f) = eta^T theta - f^T f - m^T L m - log |A| + log |L|

    The prior of the surface, s + K (centre - x0) ~ N(0, (K std)^2 + level), couples K and s.

    grams (M, 22, 22): each of N / M hypotheses in a row; they are overwritten
    """
    return _solved(_normal(grams, scene, what))


def judge_in_parts(
    grams: Array, scene: Scene, what: Hypotheses
) -> Generator[None, None, Judged]:
    """Return what `judge` does, half of the work after each call."""
    equations = _normal(grams, scene, what)
    yield
    return _solved(equations)


def _normal(grams: Array, scene: Scene, what: Hypotheses) -> _Normal:
    """Return the normal equations of hypotheses; parameters as of `judge`."""
    laws, count = what.law, len(what.law)
    of = np.repeat(np.arange(len(grams)), count // len(grams))
    reliability, rate, rest = (one[of] for one in _calibrate(grams))
    K = np.maximum(what.stiffness, _SOFTEST)
    chosen, scale = CHOSEN[laws], scales(laws, scene.depth)
    late_laws, bent = LATE[laws], np.flatnonzero(laws == BENT)
    gram = grams.reshape(len(grams), -1)[of[:, None], _FLAT[laws]].reshape(
        count, UNKNOWNS + 1, UNKNOWNS + 1) * (scale[:, :, None] * scale[:, None, :])
    if scene.lag[0] and late_laws.any():
        tau = np.where(late_laws, scene.lag[0], 0.0)  # f + tau f' for f
        late = tau[:, None] * grams[of[:, None], FORCE_RATE, chosen] * scale
        gram[:, :UNKNOWNS, UNKNOWNS] += late[:, :UNKNOWNS]
        gram[:, UNKNOWNS, UNKNOWNS] += 2.0 * late[:, UNKNOWNS] + tau * tau * grams[
            of, FORCE_RATE, FORCE_RATE]
    if len(bent):  # y^k / D^(k-1) - y, so that K is the secant at the depth
        gram[bent, 4:6] -= gram[bent, 0:1]
        gram[bent, :, 4:6] -= gram[bent, :, 0:1]
    mean, std = prior(laws, K, scene.damping, scene.lag)
    std[:, 0] = np.maximum(_DOUBT * K, _WIDE)
    std[:, 3], there, lost = _surface(scene, what, K, scale, bent)
    precision = std ** -2.0
    L = precision[:, 3, None, None] * there[:, :, None] * there[:, None, :]
    precision[:, 3] = 0.0
    L[:, _DIAGONAL, _DIAGONAL] += precision
    pulled = (L @ mean[:, :, None])[:, :, 0]
    A = gram[:, :UNKNOWNS, :UNKNOWNS] + L
    eta = gram[:, :UNKNOWNS, UNKNOWNS] + pulled
    unit = np.maximum(A[:, _DIAGONAL, _DIAGONAL], 1e-30) ** -0.5  # they differ by 1e10
    scaled = A * (unit[:, :, None] * unit[:, None, :])
    scaled[:, _DIAGONAL, _DIAGONAL] += _RIDGE
    squares = gram[:, UNKNOWNS, UNKNOWNS] + (mean * pulled).sum(1) + lost
    doubt = NOISE_DOUBT * (1.0 - reliability) / np.maximum(reliability, 1e-3)
    of_one = np.maximum(grams[of, ONE, ONE], 1e-30)
    times = _TIMES[laws]
    scatter = np.stack([
        gram[:, 0, 0] - (scale[:, 0] * grams[of, chosen[:, 0], ONE]) ** 2 / of_one,
        gram[:, 1, 1] + scale[:, 1] ** 2 * rate * (
            rate * grams[of, times, times] - 2.0 * grams[of, chosen[:, 1], times]),
        np.where(late_laws, 0.0, reliability[:, 2] ** 2 * rest)], axis=1)
    return _Normal(scaled, unit, eta, std, squares, doubt * np.maximum(scatter, 0.0))


def _surface(
    scene: Scene, what: Hypotheses, K: Array, scale: Array, bent: Ints
) -> tuple[Array, Array, Array]:
    """Return the prior of s: its deviation, the force at the surface, and what it costs."""
    # A curved law is known near x0 only: its prior is cut off by exp(-s^2 / 2 near).
    told = np.square(K * what.std) + scene.level
    near = np.where(CURVED[what.law], np.square(K * (NEAR_DEPTH * scene.depth)), np.inf)
    offset = what.centre - scene.x0
    lost = np.log1p(told / near) + np.square(K * offset) / (told + near)
    offset = offset / (1.0 + told / near)
    there = np.zeros((len(K), UNKNOWNS))
    there[:, 3], there[:, 0] = 1.0, offset
    if len(bent):
        o = offset[bent, None]
        there[bent, 4:] = o * np.concatenate([o, o * o], axis=1) * scale[bent, 4:6] - o
    return np.sqrt(1.0 / (1.0 / told + 1.0 / near)), there, lost


def _calibrate(grams: Array) -> tuple[Array, Array, Array]:
    """
    Put what is expected of depth, rate and acceleration at the place of what was measured.

    Returns the reliability of each, (N, 3), the mean rate, and what of the acceleration the others
    do not explain, (N,).

    Of the scatter of the depth about its mean a share 1 - lambda is noise of the position, which
    would bias the stiffness to lambda K. E[y | measured] = mean + lambda (y - mean) takes the
    place of y (regression calibration: Carroll et al., Measurement Error in Nonlinear Models,
    2006, ch. 4); a tool that rests tells nothing but its mean. The rate y' alike, whose noise
    would bias the damping towards 0. Of the acceleration, depth and rate explain nearly all in a
    single press: what counts is how much of the rest is noise.
    """
    of_one = np.maximum(grams[:, ONE, ONE], 1e-30)
    mean = grams[:, OF_DEPTH, ONE] / of_one[:, None]
    rate = grams[:, RATE, ONE] / of_one
    of_depth = _reliability(
        grams, NOISE, grams[:, DEPTH, DEPTH] - mean[:, 0] * grams[:, DEPTH, ONE])
    of_rate = _reliability(grams, RATE_NOISE, grams[:, RATE, RATE] - rate * grams[:, RATE, ONE])
    _move(grams, OF_RATE, of_rate, TIMES_RATE, rate[:, None, None] * np.eye(len(OF_RATE)))
    _move(grams, OF_DEPTH, of_depth, [ONE], mean[:, :, None])
    known, own = grams[:, _EXPLAIN[:, None], _EXPLAIN], grams[:, _EXPLAIN, ACCELERATION]
    unit = np.maximum(known[:, _EXPLAINED, _EXPLAINED], 1e-30) ** -0.5
    known = known * (unit[:, :, None] * unit[:, None, :]) + _RIDGE * np.eye(len(_EXPLAIN))
    share = np.linalg.solve(known, (unit * own)[:, :, None])[:, :, 0] * unit
    rest = np.maximum(grams[:, ACCELERATION, ACCELERATION] - (share * own).sum(1), 0.0)
    of_acceleration = _reliability(grams, ACCELERATION_NOISE, rest)
    _move(grams, [ACCELERATION], of_acceleration, _EXPLAIN, share[:, None])
    return np.stack([of_depth, of_rate, of_acceleration], axis=1), rate, rest


def _reliability(grams: Array, column: int, scatter: Array) -> Array:
    """Return how much of a scatter is not the noise in a column."""
    noise = grams[:, column, column]
    return np.asarray(1.0 - np.minimum(noise / np.maximum(scatter, noise + 1e-300), 1.0))


def _move(
    grams: Array, columns: list[int], reliability: Array, sources: list[int] | Ints, table: Array
) -> None:
    """Move columns, as far as they are not reliable, to what others times a table explain."""
    if reliability.min() > _CLEAN:
        return
    share = reliability[:, None, None]
    table = (1.0 - share) * table
    for rows in (grams, grams.transpose(0, 2, 1)):
        rows[:, columns] = share * rows[:, columns] + table @ rows[:, sources]


def _solved(equations: _Normal) -> Judged:
    """Return the posteriors that normal equations have."""
    scaled, unit, eta, std, squares, blur = equations
    sign, volume = np.linalg.slogdet(scaled)
    P = np.linalg.inv(scaled) * (unit[:, :, None] * unit[:, None, :])
    theta = (P @ eta[:, :, None])[:, :, 0]
    gained = (eta * theta).sum(1) - squares
    evidence = 0.5 * (gained - volume) + np.log(unit / std).sum(1)
    sound = (sign > 0.0) & np.isfinite(evidence)  # rounding may leave no positive matrix
    if not sound.all():
        evidence, theta = np.where(sound, evidence, -1e9), np.where(sound[:, None], theta, 0.0)
        P = np.where(sound[:, None, None], P, 0.0)
    if blur.any():
        moved = P[:, :, :3] * (blur * theta[:, :3])[:, None]  # by another noise of the position
        P = P + moved @ moved.transpose(0, 2, 1)
    return Judged(evidence, theta, P)


def surfaces(judged: Judged) -> tuple[Array, Array]:
    """Return how far the surface is from x0, and its variance, as -s / K says."""
    K = np.maximum(judged.theta[:, 0], 1.0)
    delta, P = -judged.theta[:, 3] / K, judged.P
    variance = P[:, 3, 3] + delta * (delta * P[:, 0, 0] + 2.0 * P[:, 0, 3])
    return delta, np.maximum(variance, 0.0) / (K * K)


class Wall(NamedTuple):
    """What hypotheses say of the wall, as one Gaussian each."""

    # stiffness, damping, surface (N,): K_e [N/m], B_e [N s/m] and x_e - x0 [m]
    stiffness: Array
    damping: Array
    surface: Array
    variances: Array  # (3, N) of the three


def walls(judged: Judged, laws: Ints, scene: Scene, reach: float) -> Wall:
    """
    Return K_e and B_e of the wall, without what the lag of the sensor has taken from B_e.

    reach: largest distance of the surface from x0 [m]
    """
    theta, P = judged.theta, judged.P
    tau, std = scene.lag
    K, linear = theta[:, 0], np.where(LATE[laws], 0.0, 1.0)
    delta, variance = surfaces(judged)
    B_variance = P[:, 1, 1] + linear * (
        (K * std) ** 2 + tau * (2.0 * P[:, 0, 1] + tau * P[:, 0, 0]))
    return Wall(
        K, theta[:, 1] + linear * tau * K, np.clip(delta, -reach, reach),
        np.stack([np.maximum(P[:, 0, 0], 0.0), np.maximum(B_variance, 0.0),
                  np.minimum(variance, reach * reach)]))


def joined(weights: Array, found: Wall, share: Array, more: Wall) -> tuple[Array, Wall]:
    """Return hypotheses with more of them, which have a share of the probability."""
    return (np.concatenate([weights * (1.0 - share.sum()), share]),
            Wall(*(np.concatenate(pair, axis=-1) for pair in zip(found, more))))


def mixture(weights: Array, found: Wall) -> tuple[list[float], list[float]]:
    """Return means and variances of K_e, B_e and x_e - x0 of those hypotheses that count."""
    weights = np.where(weights > UNLIKELY, weights, 0.0)
    weights /= weights.sum()
    values = np.stack(found[:3])
    means = values @ weights
    spreads = (found.variances + np.square(values - means[:, None])) @ weights
    return means.tolist(), spreads.tolist()


def negativity(judged: Judged, laws: Ints, scene: Scene) -> Array:
    """Return what it costs that stiffness, damping, friction and mass are not negative."""
    theta, P = judged.theta, judged.P
    damping = theta[:, 1] + np.where(LATE[laws], 0.0, scene.lag[0]) * theta[:, 0]
    values = np.stack([theta[:, 0], damping, np.where(laws == MASS, theta[:, 2], 0.0),
                       np.where((laws == FRICTION) | (laws == YIELDING), theta[:, 4], 0.0)])
    variances = np.stack([P[:, 0, 0], P[:, 1, 1], P[:, 2, 2], P[:, 4, 4]])
    below = np.square(np.minimum(values, 0.0)) / np.maximum(variances, 1e-30)
    return np.asarray(0.5 * below.sum(0))
