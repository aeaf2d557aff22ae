# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Inertial parameters that a body can have."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares

from .arm_recording import Array

_LEAST = 1e-9  # eigenvalue of a pseudo-inertia that counts as positive


def _tensor(theta: Array) -> Array:
    """Return the inertia about the origin, shape (3, 3)."""
    xx, xy, yy, xz, yz, zz = theta[4:]
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def centred(theta: Array) -> tuple[float, Array, Array]:
    """Return mass, centre (3,), and inertia about the centre (3, 3) of ten parameters."""
    mass, c = float(theta[0]), theta[1:4] / theta[0]
    return mass, c, _tensor(theta) - mass * ((c @ c) * np.eye(3) - np.outer(c, c))


def pseudo_inertia(theta: Array) -> Array:
    """Return the matrix (4, 4) that is positive definite for each possible body."""
    mass, h, J = theta[0], theta[1:4], _tensor(theta)
    upper = 0.5 * np.trace(J) * np.eye(3) - J
    return np.block([[upper, h[:, None]], [h[None, :], np.array([[mass]])]])


def of_pseudo_inertia(P: Array) -> Array:
    """Return the ten parameters of a pseudo-inertia."""
    J = np.trace(P[:3, :3]) * np.eye(3) - P[:3, :3]
    return np.array([P[3, 3], *P[:3, 3], J[0, 0], J[0, 1], J[1, 1], J[0, 2], J[1, 2], J[2, 2]])


def possible_inertial(theta: Array, covariance: Array) -> Array:
    """
    Return the likeliest parameters of a body that there can be, of a negative one for a lack.

    Log-Cholesky parameters: C. Rucker and P. M. Wensing, IEEE RA-L 7(2), 2022.

    theta (10,): fitted: mass, first moments, inertia (xx, xy, yy, xz, yz, zz)
    covariance (10, 10): of the fit
    Returns theta (10,): with a positive definite pseudo-inertia, or a negative definite one where
    mass is lacking
    """
    sign = 1.0 if theta[0] >= 0.0 else -1.0
    if np.linalg.eigvalsh(sign * pseudo_inertia(theta)).min() > _LEAST:
        return theta
    whiten = np.linalg.inv(np.linalg.cholesky(covariance + 1e-12 * np.diag(np.diag(covariance))))
    lower = np.tril_indices(4, -1)

    def body(x: Array) -> Array:
        L = np.diag(np.exp(x[:4]))
        L[lower] = x[4:]
        return sign * of_pseudo_inertia(L @ L.T)

    mass = max(abs(theta[0]), 1e-3)
    radius = np.full(3, 0.05 * np.sqrt(mass))
    start = np.concatenate([np.log(radius), [0.5 * np.log(mass)], np.zeros(6)])
    found = least_squares(lambda x: whiten @ (body(x) - theta), start, method='trf', max_nfev=200)
    return np.asarray(body(found.x))
