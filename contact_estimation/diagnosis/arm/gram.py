# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Gram matrices of all laws of an arm, block by block: a model is a small ridge regression.

With y_j what the torque of joint j has beyond RNEA, X_j the columns of a model's laws and theta
their coefficients in units of what is known of them beforehand, a fit minimises

    sum_j w_j |y_j - X_j theta|^2 + |theta|^2

over all blocks, or all but one. Laws of one joint are eliminated first (Schur complement), so that
what joints share, 24 directions of their links' inertia above all, costs one small system.
"""

from functools import lru_cache
from itertools import accumulate
from typing import Any, Iterable, Iterator, NamedTuple, Sequence

import numpy as np

from .arm_recording import Array
from .bodies import cost_of_body
from .channels import Channels, Term
from ..fit.constants import ARM
from ...kinematics.arm_dynamics import PER_LINK
from ...physics.carried_load import typical_inertial
from ...physics.joint_effects import JOINT_EFFECTS

CALIBRATION = Term('calibration')
SENSOR = Term('sensor')  # gain and zeros of the torque of a joint, as far as they are no finding
# Of the torques' gains: two published sets for one arm (UR10e) differ by 13 to 49 %, 0.24 rms in
# the logarithm, so that each is off by 1 / sqrt(2) of that.
GAIN_STD = 0.17
INEXACT = 0.05  # standard deviation of what a description knows of each link, relative
GAIN_KNOWN = 0.02  # the same of the gain of a sensor that was calibrated
# The same of its zero in each recording, in the size of the torque: so large are those of the
# Panda, TX40, TIAGo and Airbot; of the UR10e a tenth.
ZERO_KNOWN = 0.02
_WEAK = 0.05  # of the largest range of a torque
# Standard deviations of zeros that are fitted and are no finding: the level of the base, by eye
# [rad], and zero and gain of a wrench that was tared [N], [N m].
ZEROS = {Term('base_tilt'): np.full(2, 0.01),
         Term('wrench_bias'): np.array([2.0, 2.0, 2.0, 0.2, 0.2, 0.2]),
         Term('wrench_gain'): np.array([GAIN_KNOWN])}
FLOOR = ARM.instrument  # of the range of a joint's torque: what no model of an arm explains
_DIRECTIONS, _LEAST = 24, 0.002  # of calibration that move a torque by this share of its range
_NOISE_KNOWN = 0.4  # of the mean square of noise: its standard deviation to a fifth
_BLOCKS, _FEWEST = 16, 4
_ANOTHER = 2.0  # independent errors of a block at least: one alone is like its neighbours
_INDEPENDENT = ARM.independent  # errors of a block
MOST_ERRORS = _BLOCKS * _INDEPENDENT
_KEPT = 400  # eliminations: some 100 MB for seven joints


class Fitted(NamedTuple):
    """A model's fit."""

    theta: dict[Term, Array]  # coefficients
    calibration: Array  # (10 n,) change of the links' parameters that is no finding
    zeros: dict[Term, Array]  # tilt, gains and zeros of sensors, that are no finding
    # left_out, fitted (B, C): mean squares of the errors of each block and joint, of the fit on
    # the others and on all [N^2 m^2]
    left_out: Array
    fitted: Array
    known: float  # well-determined coefficients among those of laws of several joints
    # half the squared coefficients of the calibration, in those expected, and what the data lose
    # if loads leave bodies [nat]
    surprise: float


class Eliminated(NamedTuple):
    """What a joint adds to the system of the shared coefficients."""

    inner: Array  # columns of its own terms
    outer: Array  # and of shared ones
    places: Array  # of these in theta
    own: Array  # covariance of its own coefficients, given those shared
    # U, u: own coefficients are u - U shared
    U: Array
    u: Array
    # S, r: matrix and right side
    S: Array
    r: Array


class Gram:
    """
    What fits of all models need of the recordings.

    weights (C,): w_j, settable
    counts (B, C): independent errors
    size (C,): range of the torques, a twentieth of the largest at least [N m]
    reach (C,): range of the torques, with that of what the wrench takes out of them [N m]
    floor (C,): mean square of what no model explains [N^2 m^2]
    variance (C,): of the torques [N^2 m^2]
    """

    def __init__(self, channels: Channels) -> None:
        self.channels, self.joints = channels, channels.measured
        tau = np.concatenate([one.tau for one in channels.pieces])[:, self.joints]
        self.span: Array = np.ptp(np.percentile(tau, (0.5, 99.5), axis=0), axis=0) + 1e-9
        self.size: Array = np.maximum(self.span, _WEAK * self.span.max())
        felt = np.concatenate([one.felt for one in channels.pieces])[:, self.joints]
        self.felt_noise: Array = np.mean(
            [one.felt_noise for one in channels.pieces], axis=0)[self.joints]
        self.reach: Array = np.hypot(self.span, np.ptp(felt, axis=0))
        self.floor: Array = (FLOOR * self.reach) ** 2 + _NOISE_KNOWN * self.felt_noise
        self.variance: Array = tau.var(axis=0) + 1e-12
        self.order = {term: k for k, term in enumerate(channels.terms)}
        self.scales = {term: self._scale(term) for term in channels.terms}
        self.directions = self._directions()
        self.zeros = {term: std for term, std in ZEROS.items() if term in channels.terms}
        self.shared = {term for term in channels.terms
                       if JOINT_EFFECTS[term.effect].place != 'joint'
                       or len(channels.pieces[0].columns[term]) > 1}
        self.links = {term: channels.arm.neutral.reshape(-1, PER_LINK)[term.place]
                      for term in self.shared if JOINT_EFFECTS[term.effect].family == 'load'}
        self._build()
        self.set_weights(self.weights_for(self.s / self.kept))

    def _scale(self, term: Term) -> Array:
        """Return the standard deviation of the coefficients of a term before any data."""
        motion, effect = self.channels.motion, JOINT_EFFECTS[term.effect]
        if effect.typical is not None:
            return effect.typical(motion, term.place)
        sizes = []
        for k, j in enumerate(self.joints):
            rows = [one.columns[term][j] for one in self.channels.pieces if j in one.columns[term]]
            if rows:
                rms = np.sqrt(np.mean(np.concatenate(rows) ** 2, axis=0))
                sizes.append(2.0 * np.sqrt(self.variance[k]) / np.maximum(rms, 1e-9))
        return np.asarray(np.min(sizes, axis=0))

    def _directions(self) -> Array:
        """Return the directions of all links' parameters that move torques most, (10 n, D)."""
        arm = self.channels.arm
        least = 0.2 * arm.masses.mean()
        sizes = INEXACT * np.concatenate(
            [typical_inertial(max(mass, least)) for mass in arm.masses])
        Z = np.concatenate([self.channels.regressor(one, j) / self.span[k]
                            for one in self.channels.pieces
                            for k, j in enumerate(self.joints)]) * sizes
        power, V = np.linalg.eigh(Z.T @ Z * (len(self.joints) / len(Z)))
        best = np.argsort(-power)[:_DIRECTIONS]
        return np.asarray(sizes[:, None] * V[:, best[power[best] > (_LEAST * INEXACT) ** 2]])

    def _build(self) -> None:
        """Sum the products of all columns in each block."""
        pieces = self.channels.pieces
        whole = sum(len(one.t) for one in pieces)
        least = _ANOTHER * self.channels.samples_per_error
        size = max(whole / _BLOCKS, min(least, whole / _FEWEST))
        blocks = [(one, rows) for one in pieces for rows in np.array_split(
            np.arange(len(one.t)), max(1, round(len(one.t) / size)))]
        self.times = [(one.file, one.t[rows[0]], one.t[rows[-1]]) for one, rows in blocks]
        self.at = list[dict[Term, Any]]()
        self.s: Array
        self.kept: Array
        sums = list[list[tuple[Array, Array, float, float]]]()
        for j in self.joints:
            mine = [term for term in self.order if j in pieces[0].columns[term]]
            every = (CALIBRATION, SENSOR, *mine)
            self.at.append({term: np.arange(one.start, one.stop)
                            for term, one in self.places(every)})
            wide = {id(one): np.concatenate(
                [self.channels.regressor(one, j) @ self.directions,
                 *(std * one.columns[term][j] for term, std in self.zeros.items()),
                 *(std * one.columns[term][j] for term, std in self.sensor(j)),
                 *(one.columns[term][j] * self.scales[term] for term in mine),
                 np.zeros((len(one.t), 1))], axis=1)  # the last pads models of different sizes
                for one in pieces}
            sums.append([])
            for one, rows in blocks:
                keep = rows[one.moving[rows, j]]
                X, y = wide[id(one)][keep], one.residual[keep, j]
                sums[-1].append((X.T @ X, X.T @ y, float(y @ y), float(max(len(y), 1))))
        self.G = [np.array([one[0] for one in each]) for each in sums]
        self.c = [np.array([one[1] for one in each]) for each in sums]
        self.s, self.kept = (np.array([[one[k] for one in each] for each in sums]).T
                             for k in (2, 3))
        self.counts = np.minimum(_INDEPENDENT, self.kept / self.channels.samples_per_error)
        # Of the fit on all blocks but one, for each, and on all.
        self.G_fit, self.c_fit = ([np.concatenate([one.sum(0) - one, one.sum(0)[None]])
                                   for one in every] for every in (self.G, self.c))

    def beyond(self, errors: Array) -> Array:
        """Return mean squares beyond the wrench's noise, and one more unit, in the floor."""
        return np.asarray(np.maximum(errors - self.felt_noise, 0.0) / self.floor + 1.0)

    def weights_for(self, errors: Array) -> Array:
        """Return w_j for errors (B, C): those of the median sample, as far as independent."""
        order = np.argsort(errors, axis=0)
        before = np.cumsum(np.take_along_axis(self.kept, order, axis=0), axis=0)
        middle = np.argmax(before >= 0.5 * before[-1], axis=0)
        usual = np.sort(errors, axis=0)[middle, np.arange(len(middle))]
        share = np.minimum(_INDEPENDENT * len(errors) / before[-1], 1.0)
        return np.asarray(share / (usual + self.floor))

    def set_weights(self, weights: Array) -> None:
        """Weigh the joints by what a good model leaves of them."""
        self.weights: Array = weights
        self.eliminated = lru_cache(_KEPT)(self._eliminated)
        self.solve = lru_cache(1)(self._solve)  # all joints of a model are tried in turn

    def _eliminated(
        self, k: int, local: tuple[Term, ...], shared: tuple[Term, ...]
    ) -> Eliminated:
        w, inner = self.weights[k], self.index(k, local)
        outer, places = self.shared_index(k, shared)
        G, c = self.G_fit[k], self.c_fit[k]
        H = w * G[:, inner[:, None], outer]
        own = np.linalg.inv(w * G[:, inner[:, None], inner] + np.eye(len(inner)))
        U, u = own @ H, w * np.einsum('bij,bj->bi', own, c[:, inner])
        S = w * G[:, outer[:, None], outer] - H.transpose(0, 2, 1) @ U
        r = w * c[:, outer] - np.einsum('bio,bi->bo', H, u)
        return Eliminated(inner, outer, places, own, U, u, S, r)

    def index(self, k: int, terms: Iterable[Term]) -> Array:
        """Return the columns of a joint's sensor and of terms."""
        return np.concatenate([self.at[k][term] for term in (SENSOR, *terms)])

    def shared_index(self, k: int, shared: Sequence[Term]) -> tuple[Array, Array]:
        """Return the columns of shared terms in a joint, and their places in theta."""
        places = [(term, np.arange(at.start, at.stop)) for term, at in self.places(shared)
                  if term in self.at[k]]
        return (np.concatenate([self.at[k][term] for term, _ in places]),
                np.concatenate([at for _, at in places]))

    def width(self, term: Term) -> int:
        """Return the number of coefficients of a term."""
        if term == CALIBRATION:
            return int(self.directions.shape[1]) + sum(map(len, self.zeros.values()))
        return 1 + len(self.channels.names) if term == SENSOR else len(self.scales[term])

    def sensor(self, j: int) -> list[tuple[Term, float]]:
        """Return gain and zeros of the torque of a joint, with their standard deviations."""
        zero = ZERO_KNOWN * float(self.size[self.joints.index(j)])
        return [(Term('force_gain', j), GAIN_KNOWN), *(
            (Term('force_bias', j, file=file), zero) for file in range(len(self.channels.names)))]

    def split(self, model: Iterable[Term]) -> tuple[list[tuple[Term, ...]], tuple[Term, ...]]:
        """Return a model's laws of each joint alone, and those that joints share."""
        local: list[list[Term]] = [[] for _ in self.joints]
        shared = []
        for term in sorted(model, key=self.order.__getitem__):
            if term in self.shared:
                shared.append(term)
            else:
                local[self.joints.index(term.place)].append(term)
        return [tuple(one) for one in local], (CALIBRATION, *shared)

    def _solve(self, model: frozenset[Term]) -> tuple[list[Array], Array, Array]:
        """Return theta of each joint (B + 1, K), of shared terms (B + 1, S), and their system."""
        local, shared = self.split(model)
        size = sum(self.width(term) for term in shared)
        A, b = np.zeros((len(self.G_fit[0]), size, size)), np.zeros((len(self.G_fit[0]), size))
        A[:, np.arange(size), np.arange(size)] = 1.0
        for k, mine in enumerate(local):
            one = self.eliminated(k, mine, shared)
            every = len(one.places) == size  # a view is faster than a copy of its elements
            at, of = (slice(None), slice(None)) if every else (one.places[:, None], one.places)
            A[:, at, of] += one.S
            b[:, of] += one.r
        both = np.linalg.solve(A, b[:, :, None])[:, :, 0]
        inner = []
        for k, mine in enumerate(local):
            one = self.eliminated(k, mine, shared)
            inner.append(one.u - np.einsum('bio,bo->bi', one.U, both[:, one.places]))
        return inner, np.asarray(both), A

    def coefficients(self, model: frozenset[Term]) -> dict[Term, Array]:
        """Return the coefficients of the laws of a model."""
        local, shared = self.split(model)
        inner, both, _ = self.solve(model)
        theta = self.of(shared, both[-1])
        for mine, one in zip(local, inner):
            theta.update(self.of((SENSOR, *mine), one[-1]))
        return theta

    def of(self, terms: Sequence[Term], theta: Array) -> dict[Term, Array]:
        """Return the coefficients of laws among those of all terms."""
        return {term: self.scales[term] * theta[at] for term, at in self.places(terms)
                if term in self.scales}

    def fit(self, model: frozenset[Term]) -> Fitted:
        """Fit a model on all blocks, and on all but each."""
        local, shared = self.split(model)
        inner, both, A = self.solve(model)
        left_out, fitted = (np.empty_like(self.s) for _ in range(2))
        for k, mine in enumerate(local):
            one = self.eliminated(k, mine, shared)
            T = np.concatenate([inner[k], both[:, one.places]], axis=1)
            index = np.concatenate([one.inner, one.outer])
            left_out[:, k], fitted[:, k] = self.errors(k, index, T[None])[:, 0]
        spread: Array = np.asarray(np.linalg.inv(A[-1]), float)
        known = float(np.sum(1.0 - np.diag(spread)[self.width(CALIBRATION):]))
        lost = sum(cost_of_body(both[-1, at], spread[at, at], self.scales[term], self.links[term])
                   for term, at in self.places(shared) if term in self.links)
        calibration, moved = both[-1, :self.width(CALIBRATION)], self.directions.shape[1]
        sensors = np.array([one[-1, :self.width(SENSOR)] for one in inner])
        zeros = {term: self.zeros[term] * calibration[moved:][at]
                 for term, at in self.places(self.zeros)}
        zeros.update({term: np.array([std * value]) for j, values in zip(self.joints, sensors)
                      for (term, std), value in zip(self.sensor(j), values)})
        return Fitted(
            self.coefficients(model), self.directions @ calibration[:moved], zeros, left_out,
            fitted, known,
            0.5 * float(calibration @ calibration + np.sum(sensors**2)) + lost)

    def per_gain(self, model: frozenset[Term], term: Term) -> Array:
        """Return how coefficients of a law depend on the gain of each joint's torque, (C, K)."""
        # theta is linear in the torques, and a torque that is measured too large by a share g has
        # g (RNEA + y) more than y: what the column of `force_gain` adds, and y itself.
        c_fit, found = self.c_fit, []
        for k, j in enumerate(self.joints):
            gain = Term('force_gain', j)
            load = self.G_fit[k][:, :, self.at[k][gain][0]] / self.scales[gain][0]
            self.c_fit = [load + one if other == k else 0.0 * one
                          for other, one in enumerate(c_fit)]
            self.set_weights(self.weights)
            found.append(self.coefficients(model)[term])
        self.c_fit = c_fit
        self.set_weights(self.weights)
        return np.array(found)

    def places(self, terms: Iterable[Term]) -> Iterator[tuple[Term, slice]]:
        """Return the places of the coefficients of each term among those of all."""
        terms = list(terms)
        ends = [*accumulate(map(self.width, terms), initial=0)]
        return zip(terms, map(slice, ends, ends[1:]))

    def errors(self, k: int, index: Array, T: Array) -> Array:
        """Return mean squares (2, M, B), as left out and as fitted, of M fits T (M, B + 1, K)."""
        G, c = self.G[k][:, index[:, None], index], self.c[k][:, index]
        theta = of_blocks(np.moveaxis(T, 1, 0)).transpose(0, 2, 1, 3)
        left = remainder(G, c, self.s[:, k], theta.reshape(-1, *theta.shape[2:]))
        return (np.maximum(left, 0.0) / self.kept[:, k]).reshape(theta.shape[:3])


def of_blocks(T: Array) -> Array:
    """Return the coefficients of each block, (2, B, ...): of the fit without it, and on all."""
    return np.stack([T[:-1], np.broadcast_to(T[-1], T[:-1].shape)])


def remainder(G: Array, c: Array, s: Array, theta: Array) -> Array:
    """Return |y - X theta|^2 from X^T X (..., K, K), X^T y, y^T y and theta (F, ..., K)."""
    some = np.moveaxis(theta, 0, -1)
    other = np.moveaxis(np.broadcast_to(c, theta.shape), 0, -1)
    return np.asarray(s + np.moveaxis(((G @ some - 2.0 * other) * some).sum(axis=-2), -1, 0))
