# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Posterior of stiffness, damping, friction, normal and lag of a contact in three axes."""

from math import exp, pi, sqrt
from typing import Callable, NamedTuple

import numpy as np

from .estimate import EstimateStatus
from ..physics.numeric import Array

_COLUMNS = 22  # x, v, a, N u, N du/dt, change of N u by two turns of n; of three each, and 1
_CONSTANT, _SLIDING = 21, slice(9, 12)
_UNKNOWNS = 31  # K, D = B - lag K, c; mu; lag of each force, share of its square; turns of n; mass
_MU, _LAGS, _TURNS, _MASS = 21, slice(22, 25), slice(28, 30), 30
_UNKNOWN = 1e6  # prior standard deviation of K, B and c, in SI units
_WEIGHED = {_MU: 0.5, _MASS: 1.0}  # prior standard deviations of what may be 0 [1, kg]
_FRICTION_ANGLE = 0.17  # standard deviation, for a coefficient of friction up to 0.3 [rad]
_POLE, _POLE_STD = 0.75, 0.25  # share of the square of the lag: 1/2 for a delay, 1 for a pole
_SURE = 0.1  # [rad]
_TOLD = 0.95  # probability of friction or mass
_LATE = 3.0  # of timing_std, as for the check of the axes
_EXACT = 1e-5  # relative error of the forces from smoothing and its derivatives
_FITTED = 10.0  # unknowns for each force
_SEEN = 0.5  # share of noise in a direction of the columns above which it shows nothing
_STEPS = 3  # Gauss-Newton: a fourth changes no figure of `studies online --only matrix`
_MISFIT = 4.0  # variance of the residual relative to the noise, as for `~/model_fit`


class MatrixEstimate(NamedTuple):
    """Coupled stiffness and damping of a contact; axes in the order x, y, z."""

    stamp_ns: int  # stamp of the last sample used [ns]
    # stiffness, stiffness_std (3, 3): -dF_i / dx_j as fitted, not symmetrised [N/m]
    stiffness: Array
    stiffness_std: Array
    # damping, damping_std (3, 3): -dF_i / dv_j [N s/m]
    damping: Array
    damping_std: Array
    # principal, principal_std (3,): eigenvalues of the symmetric positive part of the stiffness,
    # largest first [N/m]
    principal: Array
    principal_std: Array
    directions: Array  # (3, 3) their directions, one a row
    direction_std: Array  # (3,) standard deviation of the angle of each direction [rad]
    normal: Array  # (3,) unit vector into the wall
    normal_std: float  # standard deviation of its angle [rad]
    # friction, friction_std: coefficient of Coulomb friction along the wall, weighted by its
    # probability
    friction: float
    friction_std: float
    status: EstimateStatus  # estimating, or frozen while nothing moves
    # why it is frozen, or what the forces show besides K and B: friction, or an unknown law
    reason: str


class Sums(NamedTuple):
    """Weighted sums over rows (columns, -F) of smoothed samples."""

    products: Array  # of row^T row, (25, 25)
    spread: Array  # what noise of the position adds to those of x, v and a, (9, 9)
    noise: Array  # variances of x and F, (6,)
    weight: float  # rows, as far as their noise is independent

    @classmethod
    def empty(cls) -> 'Sums':
        """Return sums over nothing."""
        size = _COLUMNS + 3
        return cls(np.zeros((size, size)), np.zeros((9, 9)), np.zeros(6), 0.0)


def posterior(
    stamp_ns: int, sums: Sums, normal: Array, timing_std: float
) -> tuple[MatrixEstimate, Array]:
    """
    Find the matrices, and the normal with which to make the rows next.

    Friction and mass are as probable as not before. A residual above the noise is an error of the
    model, and correlated: deviations are wider by its ratio to the noise.
    """
    theta, cov, ratio = _solve(sums, timing_std)
    theta, cov, moved = _weighed(theta, cov, _MASS)
    theta, cov, sliding = _weighed(theta, cov, _MU)
    K, B = theta[:18].reshape(2, 3, 3)
    std = np.sqrt(np.maximum(cov.diagonal(), 0.0))
    values, stds, directions, angles = _principal(K, cov[:9, :9])
    elastic = sums.products[_CONSTANT, -3:] - theta[_MU] * sums.products[_CONSTANT, _SLIDING]
    shown, shown_std = _normal(values, directions, angles, elastic)
    reasons = []
    if sliding > _TOLD and theta[_MU] > 0.0:
        normal = direction_of(normal + theta[_TURNS] @ tangents(normal))
        shown, shown_std = normal, float(np.linalg.norm(std[_TURNS]))
        reasons += [f'friction along the wall: mu = {theta[_MU]:.2g} +- {2.0 * std[_MU]:.1g}']
    if moved > _TOLD and theta[_MASS] > 0.0:
        reasons += [f'{theta[_MASS]:.2g} kg are accelerated: tool or wall']
    lag = float(theta[_LAGS].max())
    if lag > _LATE * timing_std:
        reasons += [f'forces lag by {1e3 * lag:.1f} ms: more than timing_std allows']
    if ratio > _MISFIT:
        reasons += [f'residual {sqrt(ratio):.1f} x noise: the law of the wall is another']
    return MatrixEstimate(
        stamp_ns, K, std[:9].reshape(3, 3), B, std[9:18].reshape(3, 3), values, stds, directions,
        angles, shown, shown_std, float(theta[_MU]), float(std[_MU]), EstimateStatus.ESTIMATING,
        '; '.join(reasons)), normal


def _coefficients(theta: Array) -> Array:
    """Return those of the columns for each force, shape (..., 3, 22): exact to lag^2."""
    K, D = (theta[..., k:k + 9].reshape(*theta.shape[:-1], 3, 3) for k in (0, 9))
    c, lag, share = (theta[..., k:k + 3, None] for k in (18, 22, 25))
    mu, first, second, mass = (theta[..., k, None, None] * np.eye(3) for k in (_MU, 28, 29, _MASS))
    inertia = mass - lag * (D + (1.0 - share) * lag * K)
    return np.concatenate([K, D, inertia, mu, -lag * mu, mu @ first, mu @ second, c], axis=-1)


def _with_damping(theta: Array) -> Array:
    """Replace D by B = D + lag K."""
    lagging = theta[..., _LAGS, None] * theta[..., :9].reshape(*theta.shape[:-1], 3, 3)
    return np.concatenate([
        theta[..., :9], theta[..., 9:18] + lagging.reshape(*theta.shape[:-1], 9),
        theta[..., 18:]], axis=-1)


def _slope(function: Callable[[Array], Array], theta: Array) -> Array:
    """Return the derivative of an analytic function by each unknown, first index."""
    return np.asarray(function(theta + 1e-20j * np.eye(_UNKNOWNS)).imag * 1e20)


def _without_noise(raw: Array, C: Array, spread: Array) -> tuple[Array, Array]:
    """Take the noise of the columns from the products (errors in variables), or what it hides."""
    scale = np.sqrt(np.maximum(raw.diagonal(), 1e-18))
    power, V = np.linalg.eigh(raw / np.outer(scale, scale))
    root = np.sqrt(np.maximum(power, 1e-12))
    half, inverse = scale[:, None] * V * root, (V / root / scale[:, None]).T
    noise, U = np.linalg.eigh(inverse[:, :9] @ spread @ inverse[:, :9].T)
    half, inverse, seen = half @ U, U.T @ inverse, noise < _SEEN
    return (half * (seen * (1.0 - noise))) @ half.T, (half * seen) @ inverse @ C


def _solve(sums: Sums, timing_std: float) -> tuple[Array, Array, float]:
    """Return unknowns, their covariance, and the variance of the residual over the noise."""
    raw, Y = sums.products[:_COLUMNS, :_COLUMNS], sums.products[_COLUMNS:, _COLUMNS:]
    A, C = _without_noise(raw, sums.products[:_COLUMNS, _COLUMNS:], sums.spread)
    mean, prior = np.zeros(_UNKNOWNS), np.full(_UNKNOWNS, _UNKNOWN)
    mean[25:28], prior[25:28], prior[_LAGS] = _POLE, _POLE_STD, max(timing_std, 1e-9)
    prior[list(_WEIGHED)], prior[_TURNS] = list(_WEIGHED.values()), _FRICTION_ANGLE
    theta, least = mean, max(_EXACT**2 * float(np.trace(Y)), 1e-18)
    for step in range(_STEPS + 1):
        T, J = _coefficients(theta), _slope(_coefficients, theta)
        known = sums.noise[3:] + T[:, :3]**2 @ sums.noise[:3] + least
        S = Y - T @ sums.products[:_COLUMNS, _COLUMNS:] * 2.0 + T @ raw @ T.T
        S = (0.5 * (S + S.T) + _FITTED * np.diag(known) / sums.weight) / sums.weight
        ratio = float(np.trace(S) * sums.weight / known.sum())
        if step == _STEPS:  # far from the solution, the misfit is no error of the model
            S = S * max(min(ratio, sums.weight), 1.0)  # at most one error common to all rows
        precision = np.linalg.inv(S)
        H = (precision @ (J @ A)).reshape(_UNKNOWNS, -1) @ J.reshape(_UNKNOWNS, -1).T
        H += np.diag(prior**-2)
        gradient = np.tensordot(J, precision @ (C.T - T @ A)) - (theta - mean) / prior**2
        scale = np.sqrt(H.diagonal())
        cov = np.linalg.inv(H / np.outer(scale, scale) + 1e-13 * np.eye(_UNKNOWNS)) / np.outer(
            scale, scale)
        theta = theta + cov @ gradient
    slope = _slope(_with_damping, theta)
    return _with_damping(theta), slope.T @ cov @ slope, ratio


def _weighed(theta: Array, cov: Array, k: int) -> tuple[Array, Array, float]:
    """Mix the hypotheses that an unknown is 0 and that it is not; return the probability too."""
    value, variance = float(theta[k]), max(float(cov[k, k]), 1e-30)
    # Savage and Dickey: the density of 0, posterior over prior.
    zero = _WEIGHED[k] / sqrt(variance) * exp(-min(0.5 * value * value / variance, 700.0))
    probability = 1.0 / (1.0 + zero)
    gain = cov[:, k] / variance
    added = (1.0 - probability) * (probability * value * value - variance)
    return (theta - (1.0 - probability) * value * gain, cov + added * np.outer(gain, gain),
            probability)


def _principal(K: Array, cov: Array) -> tuple[Array, Array, Array, Array]:
    """Return principal stiffnesses, largest first, their deviations, directions, and of angles."""
    values, vectors = np.linalg.eigh(0.5 * (K + K.T))
    values, vectors = values[::-1], vectors[:, ::-1]
    # Of v_i^T (K + K^T) v_j / 2.
    pairs = np.einsum('ai,bj->ijab', vectors, vectors)
    pairs = (0.5 * (pairs + pairs.transpose(1, 0, 2, 3))).reshape(3, 3, 9)
    variances = np.einsum('ijp,pq,ijq->ij', pairs, cov, pairs)
    gaps = values[:, None] - values[None, :]
    with np.errstate(divide='ignore', invalid='ignore'):
        turns = np.where(gaps == 0.0, pi**2, variances / gaps**2)
    np.fill_diagonal(turns, 0.0)
    angles = np.minimum(np.sqrt(np.minimum(turns, pi**2).sum(axis=1)), 0.5 * pi)
    stds = np.sqrt(np.maximum(variances.diagonal(), 0.0))
    return np.maximum(values, 0.0), stds, vectors.T, angles


def _normal(values: Array, directions: Array, angles: Array, force: Array) -> tuple[Array, float]:
    """Return the stiffest direction where it is certain, else that of the force; and its std."""
    pressing = direction_of(force)
    angle = float(angles[0])
    if angle > _SURE or values[0] < 2.0 * values[1]:
        return pressing, _FRICTION_ANGLE
    sign = 1.0 if float(directions[0] @ pressing) >= 0.0 else -1.0
    return sign * directions[0], angle


def direction_of(vector: Array) -> Array:
    """Return the unit vector; of 0, 0."""
    return np.asarray(vector / max(float(np.linalg.norm(vector)), 1e-12))


def tangents(normal: Array) -> Array:
    """Return two unit vectors, one a row, at right angles to another and to one another."""
    return np.asarray(np.linalg.svd(normal[None])[2][1:])
