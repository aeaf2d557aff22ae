# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Second-order dynamics driven by a force, as difference equations."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .numeric import Array


class SecondOrder(NamedTuple):
    """M x'' + B x' + K x = f, exactly discretised for f straight between samples."""

    denominator: Array  # (3,) of the position's transfer function
    # position, velocity (3,): numerators
    position: Array
    velocity: Array
    transition: Array  # (2, 2) of position and velocity over a sample period without a force


@lru_cache(maxsize=64)
def discretise(mass: float, damping: float, stiffness: float, h: float) -> SecondOrder:
    """
    Discretise with a first-order hold.

    mass, damping, stiffness: m [kg], B [N s/m], K [N/m]
    h: sample period [s]
    """
    from scipy.linalg import expm  # slow to import, and no node needs it

    # States x, v, f, f': the exponential of the block matrix integrates a straight f exactly.
    block = np.zeros((4, 4))
    block[0, 1], block[2, 3] = 1.0, 1.0
    block[1, :3] = -stiffness / mass, -damping / mass, 1.0 / mass
    step = expm(block * h)
    A, b_0, b_1 = step[:2, :2], step[:2, 2] - step[:2, 3] / h, step[:2, 3] / h
    denominator = np.array([1.0, -np.trace(A), np.linalg.det(A)])
    # z x = A x + b_0 f + b_1 z f; the adjugate of (z I - A) gives the numerators.
    adjugate = np.array([[A[1, 1], -A[0, 1]], [-A[1, 0], A[0, 0]]])
    low, high = -adjugate @ b_0, -adjugate @ b_1
    numerators = [np.array([b_1[i], b_0[i] + high[i], low[i]]) for i in range(2)]
    return SecondOrder(denominator, numerators[0], numerators[1], A)
