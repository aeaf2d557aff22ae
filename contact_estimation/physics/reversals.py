# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Deflections that are split where the motion reverses, for laws with a memory of reversals."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .numeric import Array


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
    """
    Return one stretch of contact.

    d, v (N,): penetration [m] and its rate [m/s]
    h: sample period [s]
    touches_down: whether the tool came from free flight between the sample before and the first
    one
    """
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
