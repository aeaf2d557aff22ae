# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Noise that is not white: hum, and a force that wanders."""

from math import sqrt
from typing import Sequence

from .constants import CLIPPED_SQUARE, COLOUR, COLOURED, NOISE_SAMPLES

SECOND = 6.0
"""Variance of a second difference of white noise, in that of the noise."""

_LEAST_SHARE = 0.1  # of the variance while few sums are known


FINEST = COLOUR[0]
"""Samples of free flight that are learned from at once."""


class Colour:
    """
    How much more the means of the noise scatter than those of white noise would.

    Hum, or a force that wanders, averages out less. Means over the samples of COLOUR show it by
    their second differences, as samples show the white noise: neither a level nor a slope, such
    as that of a slow touch, is a part of them.

    excess: variance of means over that of white noise, COLOURED before any are known
    waiting: forces of free flight that nothing has been learned from yet [N]
    """

    def __init__(self) -> None:
        self.excess = COLOURED
        self.waiting: list[float] = []
        self._scales = [_Scale(size) for size in COLOUR]

    def learn(self, white: float) -> None:
        """Learn from the forces that wait, whose white noise has a variance; 0 for none."""
        for scale in self._scales:
            scale.learn(self.waiting, white)
        self.waiting.clear()
        self.excess = max([1.0, *[scale.least for scale in self._scales]])

    @property
    def measured(self) -> float:
        """Return what of the excess is measured, 1 before anything is."""
        return max([1.0, *[scale.least for scale in self._scales if scale.is_known]])


class _Scale:
    """
    Second differences of sums over so many samples.

    least: variance over that of white noise, less two of its standard errors
    """

    def __init__(self, size: int) -> None:
        self._size, self._ratio, self._count = size, COLOURED, 1.0
        self.least = _LEAST_SHARE * COLOURED
        self._waiting: list[float] = []  # for their sum
        self._sums: list[float] = []

    @property
    def is_known(self) -> bool:
        """Return whether what was expected before any sums is forgotten."""
        return self._count >= COLOURED

    def learn(self, forces: Sequence[float], white: float) -> None:
        """Add samples, of which a whole number of times make a sum."""
        waiting = self._waiting
        waiting.extend(forces)
        if len(waiting) < self._size:
            return
        self._sums = [*self._sums[-2:], sum(waiting)]
        waiting.clear()
        if len(self._sums) == 3:
            self._count = min(self._count + 1.0, NOISE_SAMPLES)
            if white:
                bend = self._sums[2] - 2.0 * self._sums[1] + self._sums[0]
                square = bend * bend / (SECOND * self._size * white)
                most = CLIPPED_SQUARE * max(self._ratio, 1.0)
                self._ratio += ((square if square < most else most) - self._ratio) / self._count
            else:  # a sensor without noise has none that is coloured
                self._ratio = 1.0
            self.least = self._ratio * max(1.0 - 2.0 / sqrt(self._count), _LEAST_SHARE)
