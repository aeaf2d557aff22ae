# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Noise that is not white: hum, and a force that wanders."""

from __future__ import annotations

from math import sqrt
from typing import Sequence

from .constants import CLIPPED_SQUARE, COLOUR, COLOURED, NOISE_SAMPLES

SECOND = 6.0
"""Variance of a second difference of white noise, in that of the noise."""


class Colour:
    """
    How much more the means of the noise scatter than those of white noise would.

    Hum, or a force that wanders, averages out less. Means over the samples of COLOUR show it by
    their second differences, as samples show the white noise: neither a level nor a slope, such
    as that of a slow touch, is a part of them.
    """

    def __init__(self) -> None:
        self.excess = COLOURED  # variance of means over that of white noise
        self._scales = [_Scale(size) for size in COLOUR]

    @property
    def room(self) -> int:
        """Return the number of samples that change nothing but with the last of them."""
        return self._scales[0].room

    def learn(self, forces: Sequence[float], white: float) -> None:
        """Learn from samples of free flight, whose white noise has a variance; 0 for none."""
        complete, *_ = [scale.learn(forces, white) for scale in self._scales]  # the finest first
        if complete:
            self.excess = max(1.0, *(scale.least for scale in self._scales))


class _Scale:
    """Second differences of sums over so many samples."""

    def __init__(self, size: int) -> None:
        self._size, self._ratio, self._count = size, COLOURED, 1.0
        self._waiting: list[float] = []  # for their sum
        self._sums: list[float] = []

    @property
    def room(self) -> int:
        """Return the number of samples that the present sum lacks."""
        return self._size - len(self._waiting)

    @property
    def least(self) -> float:
        """Return the variance over that of white noise, less two of its standard errors."""
        return self._ratio * max(1.0 - 2.0 / sqrt(self._count), 0.1)

    def learn(self, forces: Sequence[float], white: float) -> bool:
        """Add samples, no more than there is room for; return whether a sum is complete."""
        self._waiting.extend(forces)
        if self.room:
            return False
        self._sums = [*self._sums[-2:], sum(self._waiting)]
        self._waiting.clear()
        if len(self._sums) == 3:
            self._count = min(self._count + 1.0, NOISE_SAMPLES)
            if white:
                bend = self._sums[2] - 2.0 * self._sums[1] + self._sums[0]
                square = bend * bend / (SECOND * self._size * white)
                most = CLIPPED_SQUARE * max(self._ratio, 1.0)
                self._ratio += (min(square, most) - self._ratio) / self._count
            else:  # a sensor without noise has none that is coloured
                self._ratio = 1.0
        return True
