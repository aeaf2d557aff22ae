# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Free, in contact, or neither: decided sample by sample from force and position."""

from math import exp, nan, sqrt

import numpy as np
from numpy.typing import NDArray

from .colour import Colour, FINEST, SECOND
from .constants import (
    CLIP, CLIPPED_SQUARE, LEVEL_WALK, NOISE_SAMPLES, RELEASE, SEGMENT_S, SHIFT, SLOPE_STD,
    STIFFEST, TOUCH)
from .segment import FEW, Floats, Segment

FREE, CONTACT, NEITHER = 0, 1, 2
_PRESSES = 2.0  # standard deviations below which no force is used
_SEEN = 4.0  # standard deviations of a force that CUSUM finds in four samples
_TEACHES = 0.5  # log odds of contact at a place, below which free flight teaches the level
_UNTARED = 2.0  # the same of a place below which a force from the first sample on is none
_LOOK_S = 0.06  # between looks at whether a touch was one
_SAME = 3  # equal forces in a row, from which a sensor says nothing of its noise


class ContactFilter:
    """
    Two one-sided CUSUM tests against the force of free flight, and where the surface is known.

    The noise comes from second differences, which neither a level nor a slope changes, so that a
    slow touch is not learned as noise; the level is learned only where contact is excluded. What
    was learned can be unlearned: nothing latches. A force where no wall can be, or a pull, is
    neither: it teaches nothing, and becomes the level if it stays the same over the travel, or a
    wall if it grows with the depth.

    minimum_force: contact begins above this force [N]
    least_noise: least standard deviation of the force [N]: simulated sensors have none
    level, level_variance: force in free flight [N] and its variance
    follows_level: whether the level is learned here, sample by sample
    """

    def __init__(self, minimum_force: float = 0.0, least_noise: float = 1e-3) -> None:
        self.minimum_force, self._least = minimum_force, least_noise * least_noise
        self.follows_level = True
        self.state = FREE
        self.level = self.level_variance = self._up = self._down = 0.0
        self._untared = 0.0  # log odds of contact at a place, below which a force at rest is none
        self.onset = nan  # where a force above the level was first seen of late [m]
        self._noise = self._least, 0.0, 0.0, 0, 1  # variance, last forces, equal ones, learned
        self._segment, self._rise = Segment(), Segment()
        self._stepped = 0.0, 0.0  # the level if it has stepped, and its variance
        self._look_s = SEGMENT_S  # when a force is compared with the travel
        self._pressed = 0.0  # greatest force of a contact that has grown with the depth [N]
        self._colour, self._surface = Colour(), nan  # where it may begin at most [m]

    def expect_noise(self, least: float) -> None:
        """Set the least standard deviation of the force, which may change with the motion [N]."""
        self._least = least * least

    def start(self, force: NDArray[np.float64], free: bool) -> None:
        """Learn noise, and the level where the tool is free, from the first samples [N]."""
        squares = np.sort(np.square(np.diff(force, 2)))[:-1]  # an outlier makes one large
        doubt = 1.0 + 2.0 * sqrt(4.0 / len(force))  # two of its standard deviations
        variance = max(doubt * float(np.mean(squares)) / SECOND, self._least)
        self._noise = variance, float(force[-1]), float(force[-2]), 0, len(force)
        self._colour = Colour()
        if free:
            self.set_level(float(np.median(force)), 1.6 * self.variance / len(force))
        else:  # a zero that is off by less is no sign of a touch
            self.set_level(0.0, SHIFT * SHIFT * self.variance)
            self._untared = _UNTARED

    @property
    def variance(self) -> float:
        """Variance of the noise of the force, as if it were white [N^2]."""
        return self._noise[0] * self._colour.excess

    @property
    def noise_std(self) -> float:
        """Return the standard deviation of the noise of the force [N]."""
        return sqrt(self.variance)

    @property
    def measured_std(self) -> float:
        """Return the same as measured, without what is expected before that [N]."""
        return sqrt(self._noise[0] * self._colour.measured)

    @property
    def threshold(self) -> float:
        """Force at which a contact is seen within a few samples [N]."""
        return max(_SEEN * self.noise_std, self.minimum_force)

    def exceeds_noise(self, force: float) -> bool:
        """Return whether a force is above the noise [N]: the end of a contact is seen late."""
        return force - self.level > _PRESSES * self.noise_std

    def keep(self, other: 'ContactFilter') -> None:
        """Use the noise and the level of another filter of the same samples."""
        self._noise = other._noise[0], *self._noise[1:]
        self.set_level(other.level, other.level_variance)

    def set_level(self, level: float, variance: float) -> None:
        """Set the force of free flight [N] and its variance [N^2]."""
        self.level, self.level_variance = level, variance

    @property
    def is_quiet(self) -> bool:
        """Whether the tool is free without any sign of a touch."""
        return self.state == FREE and self._up < 0.25 * TOUCH and self._down < 0.5 * TOUCH

    @property
    def probability(self) -> float:
        """Probability of contact, by the log odds that the present test has collected."""
        odds = 2.0 * SHIFT * ((RELEASE - self._down) if self.state == CONTACT
                              else self._up - TOUCH)
        return 0.0 if self.state == NEITHER else 1.0 / (1.0 + exp(-min(max(odds, -50.0), 50.0)))

    def take(
        self, dt: Floats, force: Floats, x: Floats, surface: float, std: float
    ) -> int:
        """
        Judge consecutive samples, up to and with the one that changes the state.

        dt: time since the sample before each [s]
        force, x: pressing force [N] and position [m]
        surface, std: x_e as known, NaN where it is not, and its standard deviation [m]
        Returns count: number of samples judged
        """
        before, self._surface, noise = self.state, surface - _OUTSIDE * std, self._noise
        judge = (self._in_free_flight, self._in_contact, self._in_neither)[before]
        count = judge(dt, force, x, _places(x, surface, std))
        if self.state != before:
            self._noise = noise
            self._variances(force[:count])
            self._begin_state()
        return count

    def _begin_state(self) -> None:
        """Forget what tests have collected; a level that steps does so by as much as a force."""
        self._up = self._down = 0.0
        self._segment.clear()
        self._pressed = 0.0
        self._stepped = self.level, (self._noise[1] - self.level) ** 2

    def _variances(self, forces: Floats) -> list[float]:
        """Return the variance of the white noise as known with each force."""
        variance, last, before, equal, learned = self._noise
        found: list[float] = []  # list[float]() takes ten times as long
        for force in forces:
            equal = equal + 1 if force == last else 0
            if equal < _SAME:
                bend = force - 2.0 * last + before
                square, most = bend * bend / SECOND, CLIPPED_SQUARE * variance
                if learned < NOISE_SAMPLES:
                    learned += 1
                variance += ((square if square < most else most) - variance) / learned
                variance = variance if variance > self._least else self._least
            found.append(variance)
            before, last = last, force
        self._noise = variance, last, before, equal, learned
        return found

    def _in_free_flight(self, dts: Floats, forces: Floats, xs: Floats, places: Floats) -> int:
        up, down, level, level_variance = self._up, self._down, self.level, self.level_variance
        walk, count, onset = LEVEL_WALK * LEVEL_WALK, 0, self.onset
        colour, waiting, excess = self._colour, self._colour.waiting, self._colour.excess
        for dt, force, x, place, white in zip(dts, forces, xs, places, self._variances(forces)):
            count += 1
            variance = white * excess
            waiting.append(force)
            if len(waiting) == FINEST:
                colour.learn(white if white > self._least else 0.0)
                excess = colour.excess
            if up == 0.0:
                onset = x
            deviation, pressing = sqrt(variance + level_variance), force - level
            z = pressing / deviation
            z = CLIP if z > CLIP else -CLIP if z < -CLIP else z
            up, down = up + z - SHIFT, down - z - SHIFT
            up, down = up if up > 0.0 else 0.0, down if down > 0.0 else 0.0
            if up == 0.0:
                self._untared = 0.0  # there was free flight before any force
            if up > TOUCH - place and pressing > self.minimum_force:
                still = place <= self._untared and (x - onset) * STIFFEST < pressing
                self.state = NEITHER if still or place <= _FAR_OUTSIDE else CONTACT
                self._look_s = _LOOK_S if place <= 0.0 else SEGMENT_S
                break
            if down > TOUCH + (place if place > 0.0 else 0.0):
                self.state = NEITHER
                break
            if (self.follows_level and up < 0.25 * TOUCH and down < 0.5 * TOUCH
                    and place < _TEACHES):
                level_variance += walk * variance * dt
                gain = level_variance / (level_variance + variance)
                most = 3.0 * deviation
                level += gain * (most if pressing > most else -most if pressing < -most
                                 else pressing)
                level_variance *= 1.0 - gain
        self._up, self._down, self.level, self.level_variance = up, down, level, level_variance
        self.onset = onset
        return count

    def _in_contact(self, dts: Floats, forces: Floats, xs: Floats, places: Floats) -> int:
        up, down, level, segment = self._up, self._down, self.level, self._segment
        seconds, count, kept, excess = segment.seconds, 0, 0, self._colour.excess
        whites = self._variances(forces)
        firm = (len(whites) > 1 and up == down == 0.0  # both tests stay there
                and min(places) >= 0.5 * _FAR_OUTSIDE and min(forces) - level
                > SHIFT * sqrt(max(whites) * excess + self.level_variance))
        for dt, force, place, white in zip(dts, forces, places, whites):
            count += 1
            variance = white * excess
            seconds += dt
            if not firm:
                pressing = force - level
                z = pressing / sqrt(variance + self.level_variance)
                z = CLIP if z > CLIP else -CLIP if z < -CLIP else z
                remains = z > _PRESSES and not 0.0 < self._pressed < 2.0 * pressing
                down, up = down + SHIFT - z, up + 0.5 * _FAR_OUTSIDE - (place if remains else 0.0)
                down, up = down if down > 0.0 else 0.0, up if up > 0.0 else 0.0
                if down > RELEASE:
                    self.state = NEITHER if z < -SLOPE_STD else FREE
                    break
                if up > 2.0 * TOUCH:  # a force remains where no wall is
                    self.state = NEITHER
                    break
            if seconds > self._look_s:
                segment.add(seconds, xs[kept:count], forces[kept:count])
                kept = count
                if not self._still_presses(variance) and (
                        segment.excludes_wall_near(variance, level, self._surface) or (
                            self._look_s < SEGMENT_S and segment.excludes_wall_from(
                                self.onset, variance, level))):
                    self.set_level(*segment.mean(variance))
                    self.state = FREE
                    break
                self._look_s = min(self._look_s + _LOOK_S, SEGMENT_S)
                if seconds > SEGMENT_S:
                    segment.forget(_LOOK_S / seconds)
                    seconds, self._look_s = segment.seconds, SEGMENT_S
        segment.add(seconds, xs[kept:count], forces[kept:count])
        self._up, self._down = up, down
        return count

    def _still_presses(self, variance: float) -> bool:
        """
        Return whether the force has grown with the depth, and not fallen to half since.

        No zero steps by just what a wall gives way: such a wall creeps, or moves.
        """
        pressing = self._segment.mean(variance)[0] - self.level
        if self._pressed or self._segment.is_line(CLIP * CLIP * variance):
            self._pressed = max(self._pressed, pressing)
        return 2.0 * pressing > self._pressed > 0.0

    def _in_neither(self, dts: Floats, forces: Floats, xs: Floats, places: Floats) -> int:
        """Judge samples by the level as known, and by one that has stepped to the force since."""
        count, segment = 0, self._segment
        for dt, force, x, place in zip(dts, forces, xs, places):
            count += 1
            variance = self._variances((force,))[0] * self._colour.excess
            z = (force - self.level) / sqrt(variance + self.level_variance)
            z = CLIP if z > CLIP else -CLIP if z < -CLIP else z
            self._down = max(self._down + 2.0 - abs(z), 0.0)
            segment.add(segment.seconds + dt, (x,), (force,))
            if self._down > RELEASE:
                self.state = FREE
            elif self._touches_from_stepped(force, x, variance, place):
                self.state = CONTACT
            elif segment.count % FEW == 0:
                self._judge_again(z, variance, place)
            if self.state != NEITHER:
                break
        return count

    def _touches_from_stepped(
        self, force: float, x: float, variance: float, place: float
    ) -> bool:
        """Learn the level that has stepped; return whether a wall is touched from it."""
        (level, doubt), rise = self._stepped, self._rise
        if not self._up:
            rise.clear()
        rise.add(0.0, (x,), (force,))
        z = (force - level) / sqrt(variance + doubt)
        z = CLIP if z > CLIP else -CLIP if z < -CLIP else z
        self._up = max(self._up + z - SHIFT, 0.0)
        if self._up < 0.25 * TOUCH:
            gain = doubt / (doubt + variance)
            level, doubt = level + gain * z * sqrt(variance + doubt), doubt * (1.0 - gain)
            self._stepped = level, doubt
        if self._down or self._up <= TOUCH - place or place <= _FAR_OUTSIDE or not rise.grows:
            return False
        if doubt < variance / FEW:  # else it was no level before it rose
            self.set_level(level, doubt)
            self.onset = rise.begin
        return True

    def _judge_again(self, z: float, variance: float, place: float) -> None:
        """Decide whether what is neither is a wall after all, or the level."""
        segment = self._segment
        if z > SLOPE_STD and segment.is_line(CLIP * CLIP * variance):
            self.state = CONTACT  # it grows with the depth: a wall that is nearer
        elif segment.seconds > SEGMENT_S:
            if segment.excludes_wall_near(variance, self.level) or (
                    place < _TEACHES and segment.stays(variance) and not segment.grows):
                self.set_level(*segment.mean(variance))
                self.state = FREE
            elif z > SLOPE_STD and place >= _FAR_INSIDE:
                self.state = CONTACT  # it presses where the wall is: the pull before has passed
            elif segment.seconds > 2.0 * SEGMENT_S:
                self._begin_state()


_FAR_INSIDE, _FAR_OUTSIDE = 4.0, -8.0  # log odds of contact at a place in the wall, and far off
_INSIDE, _OUTSIDE = 2.5, 4.0  # deviations of the surface, from which they are these


def _places(x: Floats, surface: float, std: float) -> Floats:
    """Return the log odds of contact by each position alone, between -8 and 4."""
    if surface != surface:
        return [0.0] * len(x)
    reach = std + 3e-5
    if len(x) == 1:
        return (_place((x[0] - surface) / reach),)
    if (min(x) - surface) / reach >= _INSIDE:
        return [_FAR_INSIDE] * len(x)
    if (max(x) - surface) / reach <= -_OUTSIDE:
        return [_FAR_OUTSIDE] * len(x)
    return [_place((one - surface) / reach) for one in x]


def _place(p: float) -> float:
    if p > 0.0:
        return 1.5 * p if p < _INSIDE else _FAR_INSIDE
    return 0.5 * p if p > -1.0 else -0.5 * p * p if p > -_OUTSIDE else _FAR_OUTSIDE
