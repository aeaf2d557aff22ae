# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Whether a force follows the position beside it, or stays the same."""

from math import nan, sqrt
from typing import Sequence

import numpy as np

from .constants import (
    ANYWHERE_M, DAMPING_S, DAMPING_STD_S, SHIFT, SLOPE_STD, TOUCH, ZERO_STEP_N)

Floats = Sequence[float]
FEW = 10
"""Samples, of which less are no level."""

_TIMES = np.linspace(0.0, DAMPING_S + 2.0 * DAMPING_STD_S, 8)[:, None]  # B_e / K_e [s]


class Segment:
    """Sums of position and force, for the line of one over the other."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget all samples."""
        self.seconds = 0.0
        self._x: list[float] = []
        self._f: list[float] = []
        self._known: tuple[int, float, float, float, float] | None = None

    def add(self, seconds: float, x: Floats, f: Floats) -> None:
        """Add samples, after which so much time has passed [s]."""
        self.seconds = seconds
        self._x.extend(x)
        self._f.extend(f)
        self._known = None

    def forget(self, share: float) -> None:
        """Forget a share of the samples, the oldest."""
        count = round(share * len(self._x))
        del self._x[:count], self._f[:count]
        self.seconds *= 1.0 - share
        self._known = None

    @property
    def count(self) -> int:
        """Return the number of samples."""
        return len(self._x)

    @property
    def begin(self) -> float:
        """Return the first position [m]."""
        return self._x[0]

    @property
    def _moments(self) -> tuple[int, float, float, float, float]:
        """Return count, mean force, and the centred sums of x^2, x f and f^2."""
        if not self._x:
            return 0, 0.0, 0.0, 0.0, 0.0
        if self._known is None:
            both = np.array([self._x, self._f])
            mean = both.mean(axis=1, keepdims=True)
            both -= mean
            (xx, xf), (_, ff) = (both @ both.T).tolist()
            self._known = len(self._x), float(mean[1, 0]), xx, xf, ff
        return self._known

    def mean(self, noise: float) -> tuple[float, float]:
        """Return the mean force [N] and its variance, given that of a sample [N^2]."""
        return float(np.add.reduce(self._f)) / len(self._f), noise / len(self._f)

    @property
    def _explained(self) -> float:
        """Return what of the sum of f^2 a line that rises with the position explains."""
        _, _, xx, xf, _ = self._moments
        return xf * xf / xx if xf > 0.0 < xx else 0.0

    @property
    def grows(self) -> bool:
        """Return whether the force grows significantly with the position."""
        count, *_, ff = self._moments
        explained = self._explained
        return explained * (count - 2) > SLOPE_STD * SLOPE_STD * (ff - explained)

    def is_line(self, least: float) -> bool:
        """Return whether a rising line is significant, and explains so much of the sum of f^2."""
        return self.grows and self._explained > least

    def stays(self, noise: float) -> bool:
        """Return whether the force scatters like noise of a variance [N^2]."""
        count, *_, ff = self._moments
        return ff <= SLOPE_STD * count * noise

    def excludes_wall_near(self, noise: float, level: float, surface: float = nan) -> bool:
        """
        Return whether the force stays where a wall would give it a slope.

        Of a wall within 0.1 m, or of one with a surface, where the tool leaves half of the depth:
        on the way in a wall may crush.
        """
        count, mean, xx, xf, ff = self._moments
        if count < FEW or xx <= 0.0 or not self.stays(noise):
            return False
        deviation = sqrt(max(noise, ff / count) / xx)
        depth, left = self._x[0] - surface, self._x[0] - self._x[-1]
        reach = depth if depth < min(2.0 * left, ANYWHERE_M) else ANYWHERE_M  # NaN: not known
        return reach * (abs(xf / xx) + SLOPE_STD * deviation) <= abs(mean - level)

    def excludes_wall_from(self, onset: float, noise: float, level: float) -> bool:
        """
        Return whether the force stays where no wall that begins at a place would leave it.

        The residual of f = K (y + B/K y'), with the best K and B/K within its prior, is larger
        than that of a constant by as much as CUSUM demands of a touch in both directions.
        """
        count, mean, xx, xf, ff = self._moments
        if (count < 3 * FEW or not self.stays(noise) or xf * xf > SLOPE_STD**2 * noise * xx
                or abs(mean - level) > SLOPE_STD * ZERO_STEP_N):
            return False
        x, force = np.array([self._x, self._f])
        half = FEW // 2
        rate = (x[2 * half:] - x[:-2 * half]) / (2 * half * self.seconds / count)
        wall = x[half:-half] - onset + _TIMES * rate
        pressed = force[half:-half] - level
        left = float(pressed @ pressed) - np.square(wall @ pressed) / np.square(wall).sum(1)
        return bool(left.min() - ff > 4.0 * SHIFT * TOUCH * noise)
