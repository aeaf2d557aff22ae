# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""From samples to the rows of a block: period, noise, lost and wild samples, frozen channels."""

from array import array
from math import inf, nan, sqrt

import numpy as np
from numpy.typing import NDArray

from .constants import JITTER_S
from .contact import ContactFilter
from .laws import Array
from .smoothing import Smoothing

_BLOCK_S = 0.020  # of samples that are processed together
_LONG, _SETTLED = 2, 8  # short blocks in a long one, and in one of a wall that stays the same
_FILLED = 3.5  # periods without a sample that are bridged
_OUTLIER, _POSITION_OUTLIER = 6.0, 10.0  # standard deviations from the median of five
_STEEP, _STEEP_POSITION = 0.15, 0.5  # of a step of that median, by which a touch may differ
_CUBIC = 1.4  # deviation of a sample from the cubic through its four neighbours
_FASTEST, _REACH = 20.0, 1e-3  # twice any arm [m/s], a step of a coarse sensor [m]
_BELIEVED = 10  # samples in a row
_SAME_RATE, _OTHER_RATE = 1e-4, 0.1  # relative errors of the period
_LONGEST_STEPS = 5000  # over which it is measured, of samples with errors of a tenth
_NOISE_SAMPLES = 200  # over which the noise of the position is averaged
_GREATEST_GAIN = 0.8  # at which noise stays positive
_JUMP = 6.0  # standard deviations of a difference that is no noise
_LEAST_VARIANCE = 1e-150  # of a signal without noise, so that its square is positive
_SIGNALS = 6  # force, x, v, two of known physics, whether the wall is learned from it
FIRST = 20
"""Samples from which period and noise are learned."""

PRESSES = 3.0
"""Standard deviations of the force, from which rows are used."""


class Blocks:
    """
    Collects samples until a block is full, and makes its rows.

    position_noise: least standard deviation of the position [m]
    period_s: of the samples [s]; 0 before it is known
    noise: variance of position [m^2] and measured rate [m^2/s^2]
    short, long, settled, wanted: samples of a short, a long, the longest and the present block
    last_t: stamp of the last sample [s]
    left: number of rows that the samples before a gap may have, to be set to 0 once they are used
    outliers, missing: forces replaced as outliers; samples missing, from the spacing of the stamps
    """

    def __init__(self, position_noise: float) -> None:
        self._least = position_noise * position_noise
        self.period_s, self.outliers, self.missing, self.left = 0.0, 0, 0, 0
        self.noise = nan, nan
        # Of samples far from each other and of neighbours, for position and rate each: variance at
        # rest, and that of the stamps [s^2].
        self._parts = [[[nan, nan] for _ in range(2)] for _ in range(2)]
        self._sparse = 1  # samples from one joint state to the next
        self._since = self._until = nan  # between which the period is measured
        self._selected: tuple[Array, Array, Array, NDArray[np.bool_]]
        self._still = nan  # force since which the position has not changed
        self.restart()

    def restart(self) -> None:
        """Begin anew with the next sample, as after a jump of the clock."""
        self.last_t, self._last_x, self._jumped = -inf, nan, 0
        self._steps = 0
        self.break_off()

    def break_off(self) -> None:
        """Forget the samples so far: nothing before a gap can be joined."""
        self._raw = array('d')
        self._filled = 0

    def step(self, t: float, x: float) -> float:
        """Return the time since the last sample [s]; 0 for one that no robot can have sent."""
        dt, T = t - self.last_t, self.period_s
        moved = x - self._last_x
        if not dt > 0.0 or (
                (moved > _REACH or moved < -_REACH) and self._jumps(dt, abs(moved))):
            return 0.0
        self.last_t, self._last_x, self._jumped = t, x, 0
        if T and dt > 1.5 * T:
            self.missing += round(dt / T) - 1 if dt < inf else 0
            if dt > _FILLED * T:
                self.left = self.close()
                self.break_off()
                self._since = t - T if dt == inf else self._since + (dt - T)
                return T
        return dt

    def noted(self, t: float, x: float) -> bool:
        """Return whether a sample is the last one that `step` has noted."""
        return t == self.last_t and x == self._last_x

    def steady(self, t: Array, x: Array) -> tuple[Array, NDArray[np.bool_]]:
        """
        Return what `step` returns for consecutive samples, and where it only notes them.

        t, x (N,): stamps [s] and positions [m]
        """
        with np.errstate(invalid='ignore'):
            dt, moved = (values - np.concatenate([[last], values[:-1]]) for values, last in (
                (t, self.last_t), (x, self._last_x)))
            T = self.period_s
            return dt, (dt > 0.5 * T) & (dt < 1.5 * T) & (np.abs(moved) <= _REACH)

    def _jumps(self, dt: float, moved: float) -> bool:
        """Return whether no tool moves so fast; so often in a row, it is elsewhere."""
        if moved <= _FASTEST * min(dt, 1.0) + _REACH:
            return False
        if self._jumped < _BELIEVED:
            self._jumped += 1
            return True
        self.break_off()
        return False

    def begin(self, stamps: Array) -> None:
        """Learn the period from the first stamps [s]."""
        self._set_period(float(np.median(np.diff(stamps))))
        self._since, self._until = float(stamps[0]), float(stamps[-1])
        self._steps = round((self._until - self._since) / self.period_s)
        self._measure_period()

    def _set_period(self, period_s: float) -> None:
        self.period_s = period_s
        self.smoothing = smooth = Smoothing(period_s)
        self.short = max(1, round(_BLOCK_S / period_s) // smooth.hop) * smooth.hop
        self.long, self.wanted = _LONG * self.short, _SETTLED * self.short
        self.settled = self.wanted
        self._buffer = np.zeros((_SIGNALS, smooth.length(self.settled // smooth.hop) + 4))
        self._filled = 0
        self._since, self._steps, self._measured = self._until, 0, FIRST - 1

    def _measure_period(self) -> None:
        """Refine the period with the time that has passed: an error of it is one of B_e."""
        if self._steps < self._measured:
            return
        period = (self._until - self._since) / self._steps
        off = abs(period / self.period_s - 1.0)
        if off > _OTHER_RATE:
            self._set_period(period)
        elif off > _SAME_RATE:
            self.smoothing = Smoothing(period, self.smoothing.of_s)  # the buffer is for these
            self.period_s = period
        if self._measured < _LONGEST_STEPS:
            self._measured *= 4
        else:
            self._since, self._steps = self._until, 0

    @property
    def pending(self) -> int:
        """Return the number of samples that wait for their block to be full."""
        return len(self._raw) // _SIGNALS

    def add(self, dt: float, sample: tuple[float, ...], taught: bool) -> int:
        """
        Add a sample.

        dt: of `step` [s]
        sample: force [N], x [m], v [m/s], and what known physics bend
        taught: whether the wall is to be learned from it
        """
        raw, T = self._raw, self.period_s
        self._until = self.last_t
        if 0.5 * T < dt < 1.5 * T:
            self._steps += 1
        else:
            steps = round(dt / T)
            self._steps += steps
            if steps > 1 and raw:
                self._bridge(steps, sample)
        raw.extend(sample)
        raw.append(taught)
        return self.close() if len(raw) >= _SIGNALS * self.wanted else 0

    def extend(self, t: float, samples: Array) -> None:
        """
        Add samples that `step` would only note, and that fill no block.

        t: stamp of the last one [s]
        samples (N, 6): as of `add`, and whether the wall is to be learned from each
        """
        self.last_t, self._last_x, self._jumped = t, float(samples[-1, 1]), 0
        self._until = t
        self._steps += len(samples)
        self._raw.frombytes(samples.tobytes())

    def _bridge(self, steps: int, now: tuple[float, ...]) -> None:
        """Fill in samples that were lost, on a straight line."""
        *last, usable = self._raw[-_SIGNALS:]
        for k in range(1, steps):
            self._raw.extend(a + k / steps * (b - a) for a, b in zip(last, now))
            self._raw.append(usable)

    def close(self) -> int:
        """End the block with the last sample; return the number of rows that it may have."""
        if not self._raw:
            return 0
        new = np.array(self._raw).reshape(-1, _SIGNALS).T
        del self._raw[:]
        buffer, count = self._buffer, min(new.shape[1], self.settled)
        buffer[:, :-count] = buffer[:, count:]
        buffer[:, -count:] = new[:, -count:]
        self._filled += count
        self._learn_noise(buffer[1:3, -min(count + 3 * self._sparse + 3, self._filled):], count)
        windows = count // self.smoothing.hop
        full = self._filled >= self.smoothing.length(windows) + 4
        self._measure_period()
        full = full and self._buffer is buffer  # of no other rate
        return windows if full and buffer[-1].any() else 0

    def last(self, count: int) -> Array:
        """Return force and position of the last samples, of at most so many, shape (2, N)."""
        pending = np.array(self._raw).reshape(-1, _SIGNALS)[:, :2].T
        known = self._buffer[:2, max(self._buffer.shape[1] - self._filled, 0):]
        return np.concatenate([known, pending], axis=1)[:, -count:]

    def newest(self, count: int) -> tuple[list[float], list[float]]:
        """Return force [N] and position [m] of the last samples of the present block."""
        raw = self._raw[len(self._raw) - count * _SIGNALS:]
        return raw[::_SIGNALS].tolist(), raw[1::_SIGNALS].tolist()

    def expect_joint_states(self, apart_s: float) -> None:
        """Say how far joint states are apart, between which the samples are on a line [s]."""
        if self.period_s:
            self._sparse = max(round(min(apart_s / self.period_s, self.short)), 1)

    def _learn_noise(self, recent: Array, count: int) -> None:
        """
        Learn the noise of position and rate from third differences, in which motion hardly shows.

        On the line from a joint state to the next one, at a share a, noise of variance s^2 is one
        of (1 - 2 p) s^2, p = a (1 - a), whose neighbours are correlated. Third differences of
        samples far apart show that, those of neighbours (1 - 3.5 p) s^2; means have s^2. Where
        several samples are on a line, 1 - 2 p is 2/3 on average, and means have as many times s^2.
        Errors of stamps add their variance times the square of the rate.
        """
        apart = self._sparse + 1  # they share no joint state
        if recent.shape[1] <= 3 * apart:
            return
        gain = min(count / _NOISE_SAMPLES, _GREATEST_GAIN)
        found: list[list[float]] = []
        for step, parts in zip((apart, 1), self._parts):
            first = recent[:, step:] - recent[:, :-step]
            third = first[:, 2 * step:] - 2.0 * first[:, step:-step] + first[:, :-2 * step]
            squares = third * third / 20.0
            rates: list[float] = []
            for part, own, square in zip(parts, squares, _means(first * first)):
                if part[0] != part[0] and square == square:
                    part[0] = max(float(np.median(own)) / 0.455, _means(own[None])[0] / 9.0)
                    part[0] += 1e-20
                    part[1] = 2.0 * JITTER_S * JITTER_S  # of stamps of both
                rates.append(max(square - 2.0 * part[0], 0.0) / (step * self.period_s) ** 2)
            totals = [rest + stamps * rate for (rest, stamps), rate in zip(parts, rates)]
            means = _means(np.minimum(squares, 9.0 * np.array(totals)[:, None]))
            for part, rate, total, mean in zip(parts, rates, totals, means):
                rest, jitter = part[0], part[1] * rate
                share = gain * (mean - total) / (rest * rest + jitter * jitter)
                part[0] = max(rest * (1.0 + share * rest), _LEAST_VARIANCE)
                part[1] *= 1.0 + share * jitter
            found.append([rest + stamps * rate for (rest, stamps), rate in zip(parts, rates)])
        if self._sparse > 1:
            noise = [1.5 * self._sparse * far for far in found[0]]
        else:
            noise = [far + 4.0 / 3.0 * max(far - near, 0.0) for far, near in zip(*found)]
        self.noise = max(noise[0], self._least, 1e-20), max(noise[1], 1e-20)

    def select(self, windows: int, contact: ContactFilter, later: int = 0) -> bool:
        """Choose the windows in contact throughout, before so many samples; whether there are."""
        smooth, deviation = self.smoothing, sqrt(contact.variance)
        count = smooth.length(windows) + 4
        if self._filled < count + later:
            return False  # the rate has changed since
        end = self._buffer.shape[1] - later
        recent = self._buffer[:, end - count:end]
        force, x, course = self._without_outliers(recent[:2], deviation, contact.level)
        inside = (recent[-1, 2:-2] > 0.0) & (course > PRESSES * deviation)
        whole = np.ones(windows, np.bool_)
        if not inside.all():
            whole = np.logical_not(np.logical_not(inside) @ smooth.bands(windows)[2])
        self._selected = force, x, recent[2:-1, 2:-2].copy(), whole
        return bool(whole.any()) and not self._is_frozen(force, x, deviation)

    def rows(self, x0: float, deepest: float) -> Array:
        """Return the rows of the windows selected, about x0; greatest position before [m]."""
        force, x, signals, whole = self._selected
        phi = self.smoothing.rows(
            force, x, signals[0], x0, self.noise, bent=signals[1:], deepest=deepest)
        return phi if whole.all() else phi[:, whole]

    def next_to_jumps(self, wall: tuple[float, float, float], variance: float) -> Array:
        """Return 0 for rows across a jump of the force, which no wall explains, 1 for others."""
        force, x, _, whole = self._selected
        K, B, surface = wall
        rate = np.gradient(x) / self.period_s
        left = force - K * (x - surface) - B * rate
        steps = np.abs(left[2:] - left[:-2])  # over two samples: a jump is one, motion is not
        usual = 3.0 * float(np.median(steps)) + _JUMP * sqrt(variance)
        jumps = np.zeros(len(x))
        jumps[1:-1] = steps > usual
        return np.asarray((jumps @ self.smoothing.bands(len(whole))[2] < 0.5)[whole], float)

    def _without_outliers(
        self, both: Array, deviation: float, level: float
    ) -> tuple[Array, Array, Array]:
        """Return force and position with medians for outliers, and the course of the force."""
        middle = both[:, 2:-2]
        bounds = _OUTLIER * deviation, _POSITION_OUTLIER * sqrt(self.noise[0]) + 1e-7
        bends = np.abs(both[:, 1:-3] - 2.0 * middle + both[:, 3:-1])
        bend, bend_of_x = np.maximum.reduce(bends, axis=1).tolist()
        if bend <= bounds[0] and bend_of_x <= bounds[1]:  # an outlier bends as much, at least
            force = middle[0] - level
            return force, middle[1], force
        window = np.lib.stride_tricks.sliding_window_view(both, 5, axis=1)
        median = np.sort(window, axis=2)[:, :, 2]
        step = np.abs(np.diff(median, axis=1, prepend=median[:, :1]))
        bound = np.array(bounds)[:, None] + np.array([[_STEEP], [_STEEP_POSITION]]) * step
        # A peak of the motion is a cubic of time, if few samples long; an outlier is none.
        cubic = (4.0 * (both[:, 1:-3] + both[:, 3:-1]) - both[:, :-4] - both[:, 4:]) / 6.0
        outside = (np.abs(middle - median) > bound) & (np.abs(middle - cubic) > _CUBIC * bound)
        self.outliers += int(np.count_nonzero(outside[0, -self.wanted:]))
        force, x = np.where(outside, median, middle)
        return force - level, x, median[0] - level

    def _is_frozen(self, force: Array, x: Array, deviation: float) -> bool:
        """Return whether a channel repeats one value while the other moves."""
        if x[0] != x[-1] or (x != x[0]).any():
            self._still = nan
            return bool(np.count_nonzero(force[1:] == force[:-1]) > 0.8 * len(force))
        mean = float(force.mean())
        if self._still != self._still:
            self._still = mean
        return abs(mean - self._still) > 5.0 * deviation / sqrt(len(x)) + 0.01 * abs(mean)


def _means(rows: Array) -> list[float]:
    """Return the mean of each row."""
    return [one / rows.shape[1] for one in np.add.reduce(rows, axis=1).tolist()]
