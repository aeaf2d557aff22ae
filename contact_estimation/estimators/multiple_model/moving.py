# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A wall that moves: its surface walks, so that old blocks tell less and less of where it is."""

from __future__ import annotations

from math import log

import numpy as np

from .constants import WALL_WALK
from .laws import Array, COLUMNS, LOG_PRIOR, MOVING, ONE

_FAR = 40.0
"""Log odds against a moving wall, from which it starts anew from what is known."""


class MovingWall:
    """
    The Gram matrix of a wall with s(t) = -K delta(t), delta a random walk, and its odds.

    A step w of the surface with variance Q takes from the matrix what it tells of s before: the
    Schur complement G - g g^T / (1 / Q + g_s), g its column of s; the evidence loses
    log(1 + Q g_s) / 2.

    gram (15, 15): of all blocks
    """

    def __init__(self) -> None:
        self.gram = np.zeros((COLUMNS, COLUMNS))
        self._norm = self._gap = 0.0

    def add(self, gram: Array, fade: float, seconds: float, scale: float) -> None:
        """Walk for a time [s], K being about the scale [N/m], and add a block."""
        walk, known = (scale * WALL_WALK) ** 2 * seconds, self.gram * fade
        column = known[ONE]
        known -= np.outer(column, column) / (1.0 / walk + column[ONE])
        self._norm = fade * self._norm - 0.5 * log(1.0 + walk * column[ONE])
        self.gram = known + gram
        self._gap *= fade

    def move(self, table: Array) -> None:
        """Move the reference of all columns; see `shifted_table`."""
        self.gram = table @ self.gram @ table.T

    @property
    def prior(self) -> float:
        """Log odds to be added to its evidence."""
        return float(LOG_PRIOR[MOVING]) + self._norm + self._gap

    def restart(self, gram: Array, gap: float) -> None:
        """Go on from the wall at rest, at log odds against it that are kept."""
        self.gram, self._norm = gram.copy(), 0.0
        self._gap = max(gap, -_FAR)

    def restart_if_far(self, gram: Array, gap: float, rest: float) -> None:
        """Start anew from the wall at rest, whose log odds are given, if all speaks against it."""
        if gap < -_FAR:
            self.restart(gram, -_FAR)
            self._gap += rest - float(LOG_PRIOR[MOVING])
