# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Samples that wait for the posterior, many at once."""

from __future__ import annotations

import numpy as np

from .blocks import Blocks
from .laws import Array

GREATEST = 1e5
"""A larger force is no measurement [N]."""


class Ahead:
    """Consecutive samples, and which of them may be taken at once."""

    def __init__(self, t: Array, force: Array, x: Array, v: Array) -> None:
        self._arrays = t, force, x
        self.t, self._force, self._x, self._v = (one.tolist() for one in (t, force, x, v))
        self._dt: list[float] = []
        self._others: list[int] = []  # from the last to the first
        self._period_s = -1.0

    def sample(self, k: int) -> tuple[float, float, float, float]:
        """Return a sample as arguments of `take`."""
        return self.t[k], self._force[k], self._x[k], self._v[k]

    def part(self, begin: int, end: int) -> tuple[list[float], list[float], list[float]]:
        """Return time steps, forces and positions."""
        return self._dt[begin:end], self._force[begin:end], self._x[begin:end]

    def steady_until(self, k: int, blocks: Blocks) -> int:
        """Return the first sample from here on that must be taken alone."""
        if k and not blocks.noted(self.t[k - 1], self._x[k - 1]):
            return k
        if blocks.period_s != self._period_s:
            self._period_s = blocks.period_s
            t, force, x = (one[k:] for one in self._arrays)
            dt, steady = blocks.steady(t, x)
            others = np.flatnonzero(~(steady & (np.abs(force) < GREATEST)))
            self._dt[k:] = dt.tolist()
            self._others = [len(self.t), *(k + others[::-1]).tolist()]
        while self._others[-1] < k:
            self._others.pop()
        return self._others[-1]
