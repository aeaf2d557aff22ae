# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Types and functions shared by the laws: signs, second-order systems, reversals."""

from functools import lru_cache
import math
from typing import Any, Iterator, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Number = TypeVar('Number', float, Any)

SIGN_VELOCITY = 4e-4
"""Usual width of the smooth sign [m/s]: sgn(v) = tanh(v / SIGN_VELOCITY)."""


def positive(x: Number, m: Any) -> Number:
    """Return max(x, 0)."""
    return max(x, 0.0) if m is math else m.maximum(x, 0.0)


def stretches(flag: Flags) -> Iterator[tuple[int, int]]:
    """Split a flag, (N,), into runs of equal values."""
    edges = [0, *(np.flatnonzero(np.diff(flag)) + 1).tolist(), len(flag)]
    yield from zip(edges[:-1], edges[1:])


class SecondOrder(NamedTuple):
    """M x'' + B x' + K x = f, exactly discretised for f straight between samples."""

    denominator: Array  # (3,) of the position's transfer function
    # position, velocity (3,): numerators
    position: Array
    velocity: Array
    transition: Array  # (2, 2) of position and velocity over a sample period without a force


@lru_cache(maxsize=64)
def discretise(mass: float, damping: float, stiffness: float, h: float) -> SecondOrder:
    """Discretise m [kg], B [N s/m], K [N/m] by a first-order hold of h [s]."""
    from scipy.linalg import expm  # slow to import, and no node needs it

    # States x, v, f / M, f' / M: the exponential of the block matrix integrates a straight f
    # exactly, and is the same in any units of length and force.
    block = np.zeros((4, 4))
    block[0, 1], block[2, 3] = 1.0, 1.0
    block[1, :3] = -stiffness / mass, -damping / mass, 1.0
    step = expm(block * h)
    A, b_0, b_1 = step[:2, :2], (step[:2, 2] - step[:2, 3] / h) / mass, step[:2, 3] / h / mass
    denominator = np.array([1.0, -np.trace(A), np.linalg.det(A)])
    # z x = A x + b_0 f + b_1 z f; the adjugate of (z I - A) gives the numerators.
    adjugate = np.array([[A[1, 1], -A[0, 1]], [-A[1, 0], A[0, 0]]])
    low, high = -adjugate @ b_0, -adjugate @ b_1
    numerators = [np.array([b_1[i], b_0[i] + high[i], low[i]]) for i in range(2)]
    return SecondOrder(denominator, numerators[0], numerators[1], A)


class Path(NamedTuple):
    """A deflection, split into legs between its reversals."""

    ways: Array  # (L,) signed length of each leg [m]
    leg: NDArray[np.int_]  # (N,) leg of each sample
    gone: Array  # (N,) distance from the beginning of that leg [m]


class Motion(NamedTuple):
    """One stretch of contact; hashable, so that what follows from it can be cached."""

    # depths, rates: penetration [m] and its rate [m/s] at the samples
    depths: bytes
    rates: bytes
    before: float  # penetration at the sample before, or of the touch-down since then [m]
    h: float  # sample period [s]


def motion_of(d: Array, v: Array, h: float, touches_down: bool) -> Motion:
    """Return a stretch of contact, (N,) [m], [m/s], [s]; touches_down: it follows free flight."""
    first = float(d[0])
    before = max(0.0, first - abs(float(v[0])) * h) if touches_down else first
    return Motion(d.tobytes(), v.tobytes(), before, h)


@lru_cache(maxsize=4)
def path_of(motion: Motion) -> Path:
    """Split a motion where its linearly interpolated rate changes sign: between the samples."""
    d, v, h = np.frombuffer(motion.depths), np.frombuffer(motion.rates), motion.h
    steps = np.diff(d, prepend=motion.before)
    turns = v[:-1] * v[1:] < 0.0
    turning = np.flatnonzero(turns)
    v_0, v_1, all_of_it = v[turning], v[turning + 1], steps[turning + 1]
    share = v_0 / (v_0 - v_1)
    out, back = 0.5 * h * v_0 * share, 0.5 * h * v_1 * (1.0 - share)
    # The rest of the measured step is split in proportion.
    out = out + share * (all_of_it - out - back)
    steps[turning + 1] -= out
    steps = np.insert(steps, turning + 1, out)
    samples = np.arange(len(d))
    samples[1:] += np.cumsum(turns)
    up = steps > 0.0
    starts = np.flatnonzero(np.concatenate(([True], up[1:] != up[:-1])))
    leg = np.zeros(len(steps), int)
    leg[starts[1:]] = 1
    leg = np.cumsum(leg)
    gone = np.cumsum(steps)
    gone -= np.concatenate(([0.0], gone[starts[1:] - 1]))[leg]
    return Path(np.add.reduceat(steps, starts), leg[samples], gone[samples])
