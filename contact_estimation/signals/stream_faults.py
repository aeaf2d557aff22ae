# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
What is wrong with a stream of messages, for checks.

Stamps in bursts, samples of two sources on one topic, a zero that steps.

"""

from typing import Iterator, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

Array = NDArray[np.float64]

CLEAR = 8.0
"""Standard deviations of its noise that a change of a signal has which is clearly no noise."""

TARE_DUE = 2.0
"""Standard deviations of the force noise from which on a wrong zero matters."""

_SHORT, _LONG = 0.25, 10.0  # quantile of the steps, and times it: a pause between bursts
_MOST_OF_TIME = 0.5  # between bursts
_LEAST_BURSTS = 5
_BRIEF, _MANY = 0.02, 50  # most of the time in bursts of many samples: else stretches between gaps
_ADJACENT = 0.2  # most pauses that another follows: else the sampling is slow there

_BLOCK = 16  # samples in which courses are told apart
_FEWEST = 3  # samples of the rarer course in a block: fewer are outliers
# Two levels CLEAR standard deviations s apart, equally often: s^2 / (s^2 + (CLEAR s / 2)^2). White
# noise has 0.30 +- 0.05 there, a uniform one 0.23, and this or less in fewer than 1e-3 of blocks.
_WITHIN = 1.0 / (1.0 + 0.25 * CLEAR**2)
_LEAST_BLOCKS, _OF_BLOCKS = 6, 0.5
_ROUNDING = 1e-9  # of the greatest value

_PIECE = 25  # samples of the shortest level
_BESIDE = 5  # samples whose median an outlier does not move
_AT_ENDS = 10  # samples in which a step before or after a contact is not seen
_LEVEL = 2.0  # most spread of a level, in standard deviations of the noise
_PERSISTS = 0.7  # of a step: afterwards the level keeps as much of it


class Bursts(NamedTuple):
    """Stamps that say when a buffer was read: messages in a burst, and the time between two."""

    size: float
    pause: float

    @property
    def text(self) -> str:
        """Return the warning, with its remedy."""
        return (f'stamps of the wrench come in bursts of about {self.size:.2g}, one every '
                f'{self.pause:.2g} s, expected even steps: they tell when a buffer was read; '
                'stamp each wrench when it is measured')


def bursts_of(t: Array) -> Bursts | None:
    """
    Find stamps in bursts: most of the time passes between them.

    t (N,): stamps in their order [s]
    """
    steps = np.diff(t)
    if len(steps) < 2 * _LEAST_BURSTS:
        return None
    short = int(_SHORT * len(steps))
    pauses = steps > _LONG * float(np.partition(steps, short)[short])
    count = int(np.count_nonzero(pauses))
    size = len(steps) / max(count, 1)
    adjacent = np.count_nonzero(pauses[1:] & pauses[:-1])
    between = 1.0 - _BRIEF if size > _MANY else _MOST_OF_TIME
    if (count < _LEAST_BURSTS or adjacent > _ADJACENT * count
            or not steps[pauses].sum() >= between * steps.sum()):
        return None
    return Bursts(size, float(np.median(steps[pauses])))


class Courses(NamedTuple):
    """The usual levels of two signals between which a stream alternates."""

    one: float
    other: float

    def text(self, signal: str, topic: str, unit: str) -> str:
        """Return the warning, with its remedy, more likely causes first."""
        return (f'the {signal} alternates between two signals, usually '
                f'{self.one:.3g} and {self.other:.3g} {unit}: two publishers or two sensors on '
                f'the topic {topic}, or a driver that fills in values it has not measured; leave '
                'one of them (ros2 topic info --verbose lists the publishers)')


def courses_of(values: NDArray[np.float64], least: float) -> Courses | None:
    """
    Find samples of two sources in one stream.

    In blocks of 16 samples the division at half of the range leaves nearly nothing, as it does for
    a step; but the levels change at least as often as by chance (Wald and Wolfowitz's number of
    runs), as no signal does that is sampled fast enough.

    values (N,): any unit, in the order of the samples
    least: range of a block from which on it counts
    """
    blocks = values[:len(values) // _BLOCK * _BLOCK].reshape(-1, _BLOCK)
    blocks = blocks[np.ptp(blocks, axis=1) > least]
    if len(blocks) < _LEAST_BLOCKS:
        return None
    blocks = blocks / np.max(np.abs(blocks))  # squares of huge values are finite
    upper = blocks >= 0.5 * (blocks.min(axis=1) + blocks.max(axis=1))[:, None]
    count = np.count_nonzero(upper, axis=1)
    changes = np.count_nonzero(upper[:, 1:] != upper[:, :-1], axis=1)
    by_chance = 2.0 * count * (_BLOCK - count) / _BLOCK
    above, whole = (blocks * upper).sum(axis=1), blocks.sum(axis=1)
    low, high = (whole - above) / np.maximum(_BLOCK - count, 1), above / np.maximum(count, 1)
    total = np.maximum(np.square(blocks).sum(axis=1) - whole * whole / _BLOCK, 1e-300)
    two = ((1.0 - 0.5 * by_chance * np.square(high - low) / total < _WITHIN)
           & (np.minimum(count, _BLOCK - count) >= _FEWEST))
    if (np.count_nonzero(two) < max(_OF_BLOCKS * len(blocks), 1)
            or changes[two].sum() < by_chance[two].sum() - 3.0 * np.sqrt(by_chance[two].sum())):
        return None
    scale = np.max(np.abs(values))
    levels = scale * np.array([low, high])[:, two]
    if np.median(levels[1] - levels[0]) < 2.0 * _resolution(values):
        return None
    return Courses(*np.median(levels, axis=1).tolist())


def _resolution(values: NDArray[np.float64]) -> float:
    """Return the least step between values, between which a coarse signal alternates by noise."""
    there = np.unique(values)
    if len(there) == 2 and 0.0 in there:
        return 0.0  # one source may fill in zeros
    steps = np.diff(there)
    return float(np.min(steps[steps > _ROUNDING * np.max(np.abs(there))], initial=np.inf))


class ZeroStep(NamedTuple):
    """When the zero of the sensor stepped, at the earliest and latest [s], and by how much [N]."""

    begin: float
    end: float
    size: float


class _Piece(NamedTuple):
    """A level of the force in free flight: first and last instant, mean, samples, deviation."""

    begin: float
    end: float
    mean: float
    samples: int
    std: float
    slope: float


def zero_steps(t: Array, force: Array, noise: float, resting: bool = True) -> list[ZeroStep]:
    """
    Find steps of the force in free flight: at once, or from before a contact to after it.

    A drift that is as fast within the levels explains what differs between them, and is no step.

    t, force (N,): time [s] and force [N] of the samples of free flight alone
    noise: standard deviation of the force, at least [N]
    resting: whether the force of free flight is one level as long as the zero is: not beside a
    weight that turns, where only what happens from one sample to the next is a step
    """
    if len(t) < 2 * _PIECE or not noise > 0.0:
        return []
    gaps = np.flatnonzero(np.diff(t) > 2.5 * float(np.median(np.diff(t)))) + 1
    found: list[ZeroStep] = []
    before: _Piece | None = None
    for first, stop in zip([0, *gaps], [*gaps, len(t)]):
        edges = [0, *_jumps(force[first:stop], noise), stop - first]
        pieces = list(_pieces(t[first:stop], force[first:stop], edges))
        then = pieces[1] if len(pieces) > 1 else None
        if before and then and not _differ(before, then, noise, True):
            pieces[0] = None  # a wall that sticks pulls, and lets go: the zero is where it was
        for k, now in enumerate(pieces):
            if now is None or now.std > _LEVEL * noise:
                before = None if k == 0 else before
                continue
            if before is None or not (k > 0 or resting):
                before = now
            elif _differ(before, now, noise, k > 0):
                found.append(ZeroStep(before.end, now.begin, now.mean - before.mean))
                before = now
            elif abs(now.mean - before.mean) < TARE_DUE * noise:  # the same level: known better
                before = _joined(before, now)
            elif now.samples >= 2 * _PIECE:
                before = now
    return found


def _jumps(force: Array, noise: float) -> list[int]:
    """Return the places after which a level differs at once from that before."""
    if len(force) < 2 * _PIECE or np.ptp(force) <= CLEAR * noise:
        return []
    middles = np.partition(sliding_window_view(force, _BESIDE), _BESIDE // 2)[:, _BESIDE // 2]
    change = np.zeros(len(force))
    change[_BESIDE:len(force) - _BESIDE + 1] = middles[_BESIDE:] - middles[:-_BESIDE]
    size, places = np.abs(change), []
    while size.max() > CLEAR * noise:
        place = int(np.argmax(size))
        sides = force[max(place - _PIECE, 0):place], force[place:place + _PIECE]
        if min(map(len, sides)) >= _AT_ENDS and _PERSISTS * size[place] < abs(
                float(np.median(sides[1]) - np.median(sides[0]))):
            near = place - 2 + np.arange(5)  # medians of five samples cannot tell which
            places.append(int(near[np.argmax(np.abs(force[near] - force[near - 1]))]))
        size[max(place - _PIECE, 0):place + _PIECE] = 0.0
    return sorted(places)


def _pieces(t: Array, force: Array, edges: list[int]) -> Iterator[_Piece | None]:
    """Yield the levels between edges, without the ends of the whole, where no step can be seen."""
    for start, end in zip(edges[:-1], edges[1:]):
        first = start + (_AT_ENDS if start == 0 else 0)
        last = end - (_AT_ENDS if end == len(t) else 0)
        first, last = (first, last) if last - first >= _AT_ENDS else (start, end)
        if last - first < _AT_ENDS:
            yield None
            continue
        own_t, own = t[first:last], force[first:last]
        away = own_t - np.mean(own_t)
        slope = float(away @ own) / max(float(away @ away), 1e-300)
        yield _Piece(float(own_t[0]), float(own_t[-1]), float(np.mean(own)), len(own),
                     float(np.std(own)), slope)


def _joined(one: _Piece, other: _Piece) -> _Piece:
    """Join two stretches of one level."""
    n = np.array([one.samples, other.samples], float)
    middle, span = (np.array([part.end + sign * part.begin for part in (one, other)])
                    for sign in (1.0, -1.0))
    mean, std, slope = np.array([(part.mean, part.std, part.slope) for part in (one, other)]).T
    away = 0.5 * middle - n @ (0.5 * middle) / n.sum()
    level = float(n @ mean / n.sum())
    inner = span**2 / 12.0  # variance of the instants of a stretch
    return _Piece(
        one.begin, other.end, level, one.samples + other.samples,
        float(np.sqrt(n @ (std**2 + (mean - level)**2) / n.sum())),
        float(n @ (inner * slope + away * (mean - level))
              / max(float(n @ (inner + away**2)), 1e-300)))


def _differ(before: _Piece, now: _Piece, noise: float, at_once: bool) -> bool:
    """Return whether two levels differ by more than noise, drift, and what settles in one."""
    change = now.mean - before.mean
    size = abs(change)
    if at_once:
        return size > _PERSISTS * CLEAR * noise
    least = TARE_DUE if min(before.samples, now.samples) >= 2 * _PIECE else CLEAR
    if size < least * noise:
        return False
    slopes, errors = np.array([
        (np.sign(change) * piece.slope,
         noise * (12.0 / piece.samples)**0.5 / max(piece.end - piece.begin, 1e-9))
        for piece in (before, now)]).T
    weights = errors**-2.0
    drift = abs(weights @ slopes) / weights.sum() + 3.0 / weights.sum()**0.5
    # What is seen to drift in one of the two may drift as fast between them, as it warms up.
    drift = max(drift, *np.where(slopes > 3.0 * errors, slopes + 3.0 * errors, 0.0))
    apart = 0.5 * (now.begin + now.end - before.begin - before.end)
    return bool(size > drift * apart)
