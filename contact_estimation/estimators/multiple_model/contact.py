# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Free, in contact, or neither: decided sample by sample from force and position."""

from __future__ import annotations

from math import exp, sqrt

import numpy as np
from numpy.typing import NDArray

from .constants import (
    ANYWHERE_M, CLIP, CLIPPED_SQUARE, LEVEL_WALK, NOISE_SAMPLES, RELEASE, SEGMENT_S, SHIFT,
    SLOPE_STD, TOUCH)

FREE, CONTACT, NEITHER = 0, 1, 2
_SECOND = 6.0  # variance of a second difference of white noise
_SAME = 3  # equal forces in a row, from which a sensor says nothing of its noise


class Segment:
    """Sums of position and force, for the line of one over the other."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget all samples."""
        self.seconds = 0.0
        self._samples: list[float] = []

    def add(self, dt: float, x: float, f: float) -> None:
        """Add a sample."""
        self.seconds += dt
        self._samples += x, f

    @property
    def count(self) -> int:
        """Return the number of samples."""
        return len(self._samples) // 2

    @property
    def moments(self) -> tuple[int, float, float, float, float]:
        """Return count, mean force, and the centred sums of x^2, x f and f^2."""
        if not self._samples:
            return 0, 0.0, 0.0, 0.0, 0.0
        both = np.array(self._samples).reshape(-1, 2)
        mean = both.sum(axis=0) / len(both)
        both -= mean
        (xx, xf), (_, ff) = (both.T @ both).tolist()
        return len(both), float(mean[1]), xx, xf, ff


class ContactFilter:
    """
    Two one-sided CUSUM tests against the force of free flight, and where the surface is known.

    The noise comes from second differences, which neither a level nor a slope changes, so that a
    slow touch is not learned as noise; the level is learned only where contact is excluded. What
    was learned can be unlearned: nothing latches. A force where no wall can be, or a pull, is
    neither: it teaches nothing, and becomes the level if it stays the same over the travel, or a
    wall if it grows with the depth.

    Parameters
    ----------
    minimum_force : float
        Contact begins above this force [N].
    least_noise : float
        Least standard deviation of the force [N]: simulated sensors have none.

    Attributes
    ----------
    state : int
        FREE, CONTACT or NEITHER.
    variance : float
        Of the white noise of the force [N^2].
    level, level_variance : float
        Force in free flight [N] and its variance.

    """

    def __init__(self, minimum_force: float = 0.0, least_noise: float = 1e-3) -> None:
        self.minimum_force, self._least = minimum_force, least_noise * least_noise
        self.state = FREE
        self.variance, self.level, self.level_variance = self._least, 0.0, 0.0
        self._up = self._down = self._last = self._before = 0.0
        self._equal, self._learned = 0, 1
        self._segment = Segment()

    def start(self, force: NDArray[np.float64], free: bool) -> None:
        """Learn noise, and the level where the tool is free, from the first samples [N]."""
        squares = np.sort(np.square(np.diff(force, 2)))[:-1]  # an outlier makes one large
        self._learned = len(force)
        doubt = 1.0 + 2.0 * sqrt(4.0 / self._learned)  # two of its standard deviations
        self.variance = max(doubt * float(np.mean(squares)) / _SECOND, self._least)
        self._before, self._last = float(force[-2]), float(force[-1])
        if free:
            self.set_level(float(np.median(force)), 1.6 * self.variance / len(force))

    def set_level(self, level: float, variance: float) -> None:
        """Set the force of free flight [N] and its variance [N^2]."""
        self.level, self.level_variance = level, variance

    @property
    def probability(self) -> float:
        """Probability of contact, by the log odds that the present test has collected."""
        odds = 2.0 * SHIFT * ((RELEASE - self._down) if self.state == CONTACT
                              else self._up - TOUCH)
        return 0.0 if self.state == NEITHER else 1.0 / (1.0 + exp(-min(max(odds, -50.0), 50.0)))

    def take(self, dt: float, force: float, x: float, surface: float, std: float) -> int:
        """
        Judge the next sample.

        Parameters
        ----------
        dt : float
            Time since the last one [s].
        force, x : float
            Pressing force [N] and position [m].
        surface, std : float
            x_e as known, NaN where it is not, and its standard deviation [m].

        Returns
        -------
        state : int
            FREE, CONTACT or NEITHER.

        """
        last, bend = self._last, force - 2.0 * self._last + self._before
        self._before, self._last = last, force
        variance, least = self.variance, self._least
        self._equal = self._equal + 1 if force == last else 0
        if self._equal < _SAME:
            square, most = bend * bend / _SECOND, CLIPPED_SQUARE * variance
            if self._learned < NOISE_SAMPLES:
                self._learned += 1
            variance += ((square if square < most else most) - variance) / self._learned
            self.variance = variance = variance if variance > least else least
        deviation = sqrt(variance + self.level_variance)
        pressing = force - self.level
        z = pressing / deviation
        z = CLIP if z > CLIP else -CLIP if z < -CLIP else z
        before = self.state
        if before == FREE:
            self._in_free_flight(dt, pressing, z, _place(x, surface, std), deviation)
        elif before == CONTACT:
            self._in_contact(dt, force, x, z, _place(x, surface, std))
        else:
            self._in_neither(dt, force, x, z, _place(x, surface, std))
        if self.state != before:
            self._up = self._down = 0.0
            self._segment.clear()
        return self.state

    def _in_free_flight(
        self, dt: float, pressing: float, z: float, place: float, deviation: float
    ) -> None:
        up, down = self._up + z - SHIFT, self._down - z - SHIFT
        self._up = up = up if up > 0.0 else 0.0
        self._down = down = down if down > 0.0 else 0.0
        if up > TOUCH - place and pressing > self.minimum_force:
            self.state = NEITHER if place <= _FAR_OUTSIDE else CONTACT
        elif down > TOUCH + max(0.0, place):
            self.state = NEITHER
        elif up < 0.25 * TOUCH and down < 0.5 * TOUCH and place < 0.5:
            variance, noise = self.level_variance, self.variance
            variance += LEVEL_WALK * LEVEL_WALK * noise * dt
            gain = variance / (variance + noise)
            most = 3.0 * deviation
            self.level += gain * (most if pressing > most else max(pressing, -most))
            self.level_variance = variance * (1.0 - gain)

    def _in_contact(self, dt: float, force: float, x: float, z: float, place: float) -> None:
        down = self._down + SHIFT - z
        self._down = down = down if down > 0.0 else 0.0
        outside = self._up - place + 0.5 * _FAR_OUTSIDE
        self._up = outside if outside > 0.0 else 0.0
        segment = self._segment
        segment.add(dt, x, force)
        if down > RELEASE:
            self.state = NEITHER if z < -SLOPE_STD else FREE
        elif self._up > 4.0 * TOUCH:  # a force remains where no wall is
            self.state = NEITHER
        elif segment.seconds > SEGMENT_S:
            if self._is_level():
                self.state = FREE
            segment.clear()

    def _in_neither(self, dt: float, force: float, x: float, z: float, place: float) -> None:
        down = self._down + 2.0 - abs(z)
        self._down = down = down if down > 0.0 else 0.0
        if down > RELEASE:
            self.state = FREE
            return
        segment = self._segment
        segment.add(dt, x, force)
        if segment.count % 10:
            return
        count, mean, xx, xf, ff = segment.moments
        noise = count * self.variance
        explained = xf * xf / xx if xf > 0.0 < xx else 0.0
        if z > SLOPE_STD and explained > max(0.5 * ff, CLIP * CLIP * self.variance):
            self.state = CONTACT  # it grows with the depth: a wall that is nearer
        elif segment.seconds > SEGMENT_S:
            if self._is_level() or ff < SLOPE_STD * noise and place < -1.0:
                self.set_level(mean, self.variance / count)
                self.state = FREE
            elif segment.seconds > 2.0 * SEGMENT_S:
                segment.clear()

    def _is_level(self) -> bool:
        """Use the force as level where a wall within 0.1 m had a slope; return whether so."""
        count, mean, xx, xf, ff = self._segment.moments
        if count < 10 or xx <= 0.0 or ff > SLOPE_STD * count * self.variance:
            return False
        deviation = sqrt(max(self.variance, ff / count) / xx)
        if abs(xf / xx) + SLOPE_STD * deviation > abs(mean - self.level) / ANYWHERE_M:
            return False
        self.set_level(mean, self.variance / count)
        return True


_FAR_OUTSIDE = -8.0  # log odds of contact at a place where no wall is


def _place(x: float, surface: float, std: float) -> float:
    """Return the log odds of contact by the position alone, between -8 and 4."""
    if surface != surface:
        return 0.0
    p = (x - surface) / (std + 3e-5)
    if p > 0.0:
        return 1.5 * p if p < 2.5 else 4.0
    return 0.5 * p if p > -1.0 else -0.5 * p * p if p > -4.0 else _FAR_OUTSIDE
