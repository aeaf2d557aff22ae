# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Models with one law less, without another fit.

A coefficient that is held at 0 moves all others by -C_g C_gg^-1 theta_g, C being the covariance of
the fit: the Schur complement, exact for the fit on all blocks and for those on all but one.
"""

import numpy as np

from .arm_recording import Array
from .channels import Term
from .gram import CALIBRATION, Fitted, Gram, SENSOR


def without_each(gram: Gram, model: frozenset[Term]) -> dict[Term, Fitted]:
    """Return a model's fit without each law, but for theta and whether loads are bodies."""
    local, shared = gram.split(model)
    inner, both, A = gram.solve(model)
    spread: Array = np.asarray(np.linalg.inv(A), float)
    ways = [gram.eliminated(k, mine, shared) for k, mine in enumerate(local)]
    terms = list[tuple[Term, int]]()  # with the number of the joint of a local one
    far, lost, near = list[Array](), list[Array](), dict[int, Array]()
    for term, at in gram.places(shared):
        if term != CALIBRATION:
            far.append(_moved(spread[:, :, at], spread[:, at, at], both[:, at]))
            lost.append(_lost(spread[-1, :, at], spread[-1, at, at]))
            terms.append((term, -1))
    for k, (mine, one) in enumerate(zip(local, ways)):
        across = -one.U @ spread[:, one.places]
        own = one.own - across[:, :, one.places] @ one.U.transpose(0, 2, 1)
        for term, at in gram.places((SENSOR, *mine)):
            if term != SENSOR:
                C = across[:, at].transpose(0, 2, 1)
                near[len(terms)] = _moved(own[:, :, at], own[:, at, at], inner[k][:, at])
                far.append(_moved(C, own[:, at, at], inner[k][:, at]))
                lost.append(_lost(C[-1], own[-1, at, at]))
                terms.append((term, k))
    theta = both + np.reshape(far, (len(far), *both.shape))  # (M, B + 1, S)
    sensors, errors = [], []
    for k, one in enumerate(ways):
        T = inner[k] - np.einsum('bio,mbo->mbi', one.U, (theta - both)[..., one.places])
        for m, change in near.items():
            if terms[m][1] == k:
                T[m] = inner[k] + change
        sensors.append(T[:, -1, :gram.width(SENSOR)])
        errors.append(gram.errors(k, np.concatenate([one.inner, one.outer]),
                                  np.concatenate([T, theta[..., one.places]], axis=2)))
    left_out, fitted = np.moveaxis(np.array(errors), 0, -1)  # (M, B, C) each
    size = gram.width(CALIBRATION)
    surprise = 0.5 * (np.sum(np.square(sensors), axis=(0, 2))
                      + np.sum(theta[:, -1, :size] ** 2, axis=1))
    known = np.sum(1.0 - np.diagonal(spread[-1])[size:])
    return {term: Fitted(
        {}, theta[m, -1, :0], {}, left_out[m], fitted[m],
        float(known + lost[m][size:].sum()) - (gram.width(term) if k < 0 else 0),
        float(surprise[m])) for m, (term, k) in enumerate(terms)}


def _moved(C: Array, own: Array, value: Array) -> Array:
    """Return how coefficients, C (B + 1, K, n) their covariance, change if n are held at 0."""
    return np.asarray(-(C @ np.linalg.solve(own, value[..., None]))[..., 0])


def _lost(C: Array, own: Array) -> Array:
    """Return the variance that coefficients lose, (K,)."""
    return np.asarray(np.sum(C * np.linalg.solve(own, C.T).T, axis=1))
