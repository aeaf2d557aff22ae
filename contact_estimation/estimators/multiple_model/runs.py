# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The times since which the wall may be another."""

from math import inf, log, nan
from typing import Generator, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .constants import (
    CHANGES, COMMIT, EXACT_SURFACE_M, NEW_WALL, OBSERVED_S, RUNS, ZERO_STEP_N, ZERO_STEPS)
from .evidence import Hypotheses, judge_in_parts, Judged, negativity, Scene, surfaces
from .laws import Array, COLUMNS, DEPTH, FORCE, Ints, ONE


LEAST_BLOCKS = 2
"""Blocks of another wall: one may hold half of a jump, where that is no surprise."""

_YOUNG_S = 0.02  # added to all ages: a short block
_KEPT_STD = 2e-6  # least deviation of a surface that was found [m]


class Change(NamedTuple):
    """The hypotheses that something has changed, against the one that nothing has."""

    odds: Array  # (N,) log odds of each
    judged: Judged  # the wall since then
    # centre, std (N,): prior of its surface [m]
    centre: Array
    std: Array
    run: Ints  # (N,) index of the run
    as_before: NDArray[np.bool_]  # (N,) whether the surface is the one before it
    # (N,) variance of a shift of the force where that is the change [N^2], 0 of another wall
    shift: Array

    @property
    def shares(self) -> Array:
        """Return the probability of each."""
        odds = np.append(self.odds, 0.0)
        return np.asarray(np.exp(odds - np.logaddexp.reduce(odds))[:-1])


class Before(NamedTuple):
    """What was before each run."""

    used: Ints  # (N,) indices of the runs
    since: Array  # (N, 22, 22) Gram matrices since then
    judged: Judged  # the wall before
    old: Ints  # which of them are old enough for another wall
    what: Hypotheses  # (N,) which wall that is, at the surface that explains it best
    prior: Array  # (N,) log prior of its surface
    gram: Array  # (22, 22) of all data


class Touch(NamedTuple):
    """Where a contact began."""

    # place, std: of the touch [m]; NaN for a time within a contact
    place: float
    std: float
    again: bool  # whether of a wall that was known, and from outside of it


_NO_TOUCH = Touch(nan, nan, False)


class Runs:
    """
    Gram matrices since up to RUNS times, spaced like powers.

    A change at a time splits the data: p(before) p(since | surface as before) against p(all)
    (Adams and MacKay 2007, on a pruned set of run lengths). Without motion only the force tells
    it; the surface, known from before, gives the new stiffness then.

    changes: changes within contacts so far, and those of the prior
    seconds: time in contact, and that of the prior [s]
    """

    def __init__(self) -> None:
        self.changes, self.seconds = CHANGES, OBSERVED_S
        self.clear()

    def clear(self) -> None:
        """Forget all runs."""
        self._grams = np.zeros((RUNS + 1, COLUMNS, COLUMNS))
        self._ages: list[int] = []
        self._seconds: list[float] = []
        self._touches: list[Touch] = []

    def begin(self, touch: Touch = _NO_TOUCH) -> None:
        """Begin a run, at a touch or without one."""
        count = len(self._ages)
        if count > RUNS:
            self._drop(1 + self._least_useful())
            count -= 1
        self._grams[count] = 0.0
        self._ages.append(0)
        self._seconds.append(0.0)
        self._touches.append(touch)

    def _least_useful(self) -> int:
        """Return the inner run whose neighbours are nearest to each other in their ratio."""
        ages = [age + _YOUNG_S for age in self._seconds]
        ratios = [inf if touch.place == touch.place else before / after
                  for before, touch, after in zip(ages, self._touches[1:], ages[2:])]
        return ratios.index(min(ratios))

    def _drop(self, index: int) -> None:
        count = len(self._ages)
        self._grams[index:count - 1] = self._grams[index + 1:count]
        del self._ages[index], self._seconds[index], self._touches[index]

    def add(self, gram: Array, fade: float, seconds: float) -> None:
        """Add a block to every run."""
        runs = self._grams[:len(self._ages)]
        runs *= fade
        runs += gram
        self._ages = [age + 1 for age in self._ages]
        self._seconds = [age + seconds for age in self._seconds]
        self.seconds += seconds

    def move(self, table: Array) -> None:
        """Move the reference of all columns; see `shifted_table`."""
        count = len(self._ages)
        self._grams[:count] = table @ self._grams[:count] @ table.T

    def recent(self, seconds: float) -> Array:
        """Return the Gram matrix of the youngest run of at least so many seconds, else oldest."""
        old = [k for k, age in enumerate(self._seconds) if age >= seconds]
        return self._grams[old[-1] if old else 0]

    def judge(
        self, gram: Array, scene: Scene, what: Hypotheses, prior: Array, least: int, alone: float,
        block_s: float,
    ) -> Generator[None, None, Change | None]:
        """Judge a change at each run, in parts; parameters as of `_before` and `_since`."""
        before = yield from self._before(gram, scene, what, prior, least)
        if before is None:
            return None
        yield
        change = yield from self._since(before, scene, alone, block_s)
        return change

    def _before(
        self, gram: Array, scene: Scene, what: Hypotheses, prior: Array, least: int
    ) -> Generator[None, None, Before | None]:
        """
        Judge what was before each run, in parts.

        gram (22, 22): of all data
        what: one law with each of its surfaces
        prior (M,): log prior of these
        least: blocks that another wall must have within a contact
        """
        at, _, again = np.array(self._touches).reshape(-1, 3).T
        old = np.array(self._ages) >= np.where(at == at, LEAST_BLOCKS, least)
        used = np.flatnonzero(old | (again > 0.0) & (np.array(self._ages) > 0))
        if not len(used):
            return None
        since, places = self._grams[used], len(prior)
        count = len(used)
        judged = yield from judge_in_parts(
            gram - since, scene, Hypotheses(
                np.tile(what.law, count), *(np.tile(one, count) for one in what[1:])))
        evidence = judged.evidence.reshape(-1, places) + prior
        place = evidence.argmax(axis=1)
        best = place + places * np.arange(count)
        return Before(used, since, Judged(
            evidence.max(axis=1), judged.theta[best], judged.P[best]), np.flatnonzero(old[used]),
            Hypotheses(*(one[place] for one in what)), prior[place], gram)

    def _since(
        self, before: Before, scene: Scene, evidence: float, block_s: float
    ) -> Generator[None, None, Change]:
        """
        Judge the wall since each run, and whether it is another one, in parts.

        Within a contact, and at a touch of a known wall, the zero of the sensor may have stepped
        instead.

        evidence: of the law on all data, with its prior
        block_s: duration of a block [s]
        """
        used, since, judged, old, what, prior, gram = before
        near, near_std = places(judged, scene)
        touches, doubts, again = np.array(self._touches)[used].T
        touched = old[touches[old] == touches[old]]  # the surface may be another one too
        within = old[touches[old] != touches[old]]  # the wall may be the same
        same = np.concatenate([within, np.flatnonzero(again)])
        run = np.concatenate([old, touched, same])
        centre = np.concatenate([near[old], touches[touched], near[same]])
        std = np.concatenate([near_std[old], doubts[touched], near_std[same]])
        rate = self.changes / self.seconds * block_s
        is_same = np.arange(len(run)) >= len(run) - len(same)
        hazard = np.where(touches[run] == touches[run], log(0.5 * NEW_WALL), np.log(
            np.where(is_same, ZERO_STEPS, 1.0) * rate))
        shift = np.zeros(len(run))
        shift[is_same] = np.where(again[same], np.square(
            what.stiffness[same] * scene.depth), ZERO_STEP_N ** 2)
        grams = since[run]
        stiffness = np.maximum(_secant(grams, centre - scene.x0), 1.0)
        grams[is_same], cost = shifted(gram, since[same], shift[is_same])
        found = yield from judge_in_parts(grams, scene, Hypotheses(
            what.law[run], *(np.where(is_same, kept[run], other) for kept, other in zip(
                what[1:], (stiffness, centre, std)))))
        odds = found.evidence - evidence + hazard - negativity(found, what.law[run], scene)
        odds[is_same] += cost + prior[same]
        odds[~is_same] += judged.evidence[run[~is_same]]
        as_before = np.ones(len(run), bool)
        as_before[len(old):len(old) + len(touched)] = False
        return Change(odds, found, centre, std, used[run], as_before, shift)

    def commit(self, run: int) -> Array:
        """Drop what was before a run; return its Gram matrix."""
        gram, touched = self._grams[run].copy(), self._touches[run][0] == self._touches[run][0]
        for _ in range(run + 1):
            self._drop(0)
        if not touched:
            self.changes += 1.0
        return gram


def places(judged: Judged, scene: Scene) -> tuple[Array, Array]:
    """Return where the surface is under each hypothesis, and its standard deviation [m]."""
    delta, variance = surfaces(judged)
    reach = scene.depth * scene.depth  # too few data do not tell the surface: it is near x0
    delta, variance = np.where(variance < reach, delta, 0.0), np.minimum(variance, reach)
    return scene.x0 + delta, np.sqrt(variance) + _KEPT_STD


def shifted(gram: Array, part: Array, variance: Array) -> tuple[Array, Array]:
    """
    Return data in a part of which the force may have shifted, and what the evidence loses.

    gram, part (22, 22), (N, 22, 22): of all data, and of the part
    variance (N,): of the shift [N^2]
    """
    column = part[:, ONE]
    told = 1.0 + variance * column[:, ONE]
    taken = (variance / told)[:, None, None] * column[:, :, None] * column[:, None, :]
    return gram - taken, -0.5 * np.log(told)


def in_doubt(gram: Array, part: Array, delta: float, variance: float) -> Array:
    """
    Return data in a part of which the zero, the stiffness or both were others.

    At rest either explains a step of the force, which has a variance [N^2].

    gram, part (22, 22): of all data, and of the part
    delta: surface less x0 [m]
    """
    to_depth = np.array([[1.0, -delta], [0.0, 1.0]])
    columns = part[:, [ONE, DEPTH]] @ to_depth
    both = to_depth.T @ columns[[ONE, DEPTH]]
    depth = max(both[0, 1] / max(both[0, 0], 1e-300), EXACT_SURFACE_M)
    told = both + np.diag([1.0, depth * depth]) / variance
    return np.asarray(gram - columns @ np.linalg.solve(told, columns.T))


def decided(change: Change | None) -> int:
    """
    Return the index of the change that is certain enough to forget what was before; -1.

    Another wall, as long as a shift of the force is not certain: see `SameWall`.
    """
    if change is None:
        return -1
    best, wall = (int(np.argmax(odds)) for odds in (
        change.odds, np.where(change.shift, -np.inf, change.odds)))
    if change.odds[best] <= COMMIT:
        return -1
    return best if change.odds[best] - change.odds[wall] > COMMIT else wall


def _secant(grams: Array, delta: Array) -> Array:
    """Return the force over the depth of a surface that is elsewhere, by least squares [N/m]."""
    product = grams[:, DEPTH, FORCE] - delta * grams[:, ONE, FORCE]
    square = (grams[:, DEPTH, DEPTH] - 2.0 * delta * grams[:, ONE, DEPTH]
              + delta * delta * grams[:, ONE, ONE])
    return np.clip(product / np.maximum(square, 1e-30), 0.0, 1e8)
