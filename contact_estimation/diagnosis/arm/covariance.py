# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The covariance of a fit, and models with one law less, without another fit.

A coefficient that is held at 0 moves all others by -C_g C_gg^-1 theta_g, C being the covariance:
the Schur complement, exact for the fit on all blocks and for those on all but one.
"""

from typing import Iterator, NamedTuple

import numpy as np

from .arm_recording import Array
from .channels import Term
from .gram import CALIBRATION, Fitted, Gram, SENSOR


class _Spread(NamedTuple):
    """Covariance of the n coefficients of a law, in the scales of their prior."""

    term: Term
    k: int  # the number of the joint of a law of one, or -1
    at: slice  # among the coefficients of the joint, or of the shared ones
    own: Array  # (B + 1, n, n)
    shared: Array  # (B + 1, S, n) with the shared ones
    local: Array  # (B + 1, I, n) with those of the joint


def _spreads(gram: Gram, model: frozenset[Term], C: Array) -> Iterator[_Spread]:
    """Yield the covariance of each law; C (B + 1, S, S): of what joints share."""
    local, shared = gram.split(model)
    for term, at in gram.places(shared):
        if term != CALIBRATION:
            yield _Spread(term, -1, at, C[:, at, at], C[:, :, at], C[:, :0, at])
    for k, mine in enumerate(local):
        one = gram.eliminated(k, mine, shared)
        across = -one.U @ C[:, one.places]
        own = one.own - across[:, :, one.places] @ one.U.transpose(0, 2, 1)
        for term, at in gram.places((SENSOR, *mine)):
            if term != SENSOR:
                yield _Spread(term, k, at, own[:, at, at], across[:, at].transpose(0, 2, 1),
                              own[:, :, at])


def covariance(gram: Gram, model: frozenset[Term]) -> dict[Term, Array]:
    """Return the covariance of the coefficients of each law of a model."""
    C: Array = np.asarray(np.linalg.inv(gram.solve(model)[2]), float)
    return {one.term: one.own[-1] * np.outer(gram.scales[one.term], gram.scales[one.term])
            for one in _spreads(gram, model, C)}


def without_each(gram: Gram, model: frozenset[Term]) -> dict[Term, Fitted]:
    """Return a model's fit without each law, but for theta and whether loads are bodies."""
    local, shared = gram.split(model)
    inner, both, A = gram.solve(model)
    C: Array = np.asarray(np.linalg.inv(A), float)
    size = gram.width(CALIBRATION)
    laws = list(_spreads(gram, model, C))
    gone = [np.linalg.solve(one.own, (both if one.k < 0 else inner[one.k])[:, one.at, None])
            for one in laws]
    theta = both - np.reshape([one.shared @ x for one, x in zip(laws, gone)],
                              (len(laws), *both.shape))  # (M, B + 1, S)
    sensors, errors = [], []
    for k, mine in enumerate(local):
        way = gram.eliminated(k, mine, shared)
        T = inner[k] - np.einsum('bio,mbo->mbi', way.U, (theta - both)[..., way.places])
        for m, one in enumerate(laws):
            if one.k == k:
                T[m] = inner[k] - (one.local @ gone[m])[..., 0]
        sensors.append(T[:, -1, :gram.width(SENSOR)])
        errors.append(gram.errors(k, np.concatenate([way.inner, way.outer]),
                                  np.concatenate([T, theta[..., way.places]], axis=2)))
    left_out, fitted = np.moveaxis(np.array(errors), 0, -1)  # (M, B, C) each
    surprise = 0.5 * (np.sum(np.square(sensors), axis=(0, 2))
                      + np.sum(theta[:, -1, :size] ** 2, axis=1))
    found = dict[Term, Fitted]()
    for m, one in enumerate(laws):
        cross = one.shared[-1]
        less = np.sum(cross * np.linalg.solve(one.own[-1], cross.T).T, axis=1)  # of the variance
        known = np.sum((1.0 - np.diagonal(C[-1]) + less)[size:])
        found[one.term] = Fitted(
            {}, theta[m, -1, :0], {}, left_out[m], fitted[m],
            float(known) - (gram.width(one.term) if one.k < 0 else 0), float(surprise[m]))
    return found
