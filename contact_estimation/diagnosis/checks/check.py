# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a check is, what it measures of a recording, and the few numbers by which it judges."""

from dataclasses import dataclass
from math import sqrt
from typing import Any, Callable, NamedTuple

import numpy as np

from ..observe.shares import MOST, MUCH, SLIGHT
from ..observe.signals import Signals
from ...physics import EFFECTS
from ...physics.numeric import Array


@dataclass(frozen=True)
class Check:
    """The result of a check for wrong use."""

    name: str  # as in `CHECKS`
    ok: bool  # false if something is to be corrected
    text: str  # measured, expected and, if not ok, what to change
    fatal: bool = False  # whether nothing can be diagnosed before that
    could_cause: frozenset[str] = frozenset()  # effects that the wrong use would be mistaken for
    tested: bool = True  # false if the data, or another check that failed, leave it open


class Finding(NamedTuple):
    """The outcome of a test: `ok`, `text` and, if not ok, `fatal`, as of `Check`."""

    ok: bool
    text: str
    fatal: bool = True


@dataclass(frozen=True)
class Test:
    """A test for one kind of wrong use."""

    find: Callable[[Any], Finding]  # from the `Quantities` of a recording to the finding
    after: tuple[str, ...] = ()  # checks that must have passed: else this one has no meaning
    # effects for which a failure that is not fatal would be mistaken
    could_cause: frozenset[str] = frozenset()
    # whether it has a meaning only where nothing else is fitted together with the recording
    alone: bool = False
    # from the signals that fail to those to be fitted, where that is beyond doubt
    put_right: Callable[[Signals], Signals] | None = None


def of_families(*families: str) -> frozenset[str]:
    """Return the names of the effects of some families."""
    return frozenset(name for name, cls in EFFECTS.items() if cls.family in families)


FOLLOWS, UNRELATED = sqrt(MOST), sqrt(MUCH)
"""Correlations: one signal explains most of the variance of another, or not much of it."""

WORTH_A_NAME = 0.006
"""Share of the range of the force below which nothing is named, see `conclude`."""

STRAIGHT = SLIGHT
"""Bend, see `bend_of`, of one stroke at constant speed, at most."""

LISTED = 5
"""Times or places that a text lists; '...' stands for more."""


class Line(NamedTuple):
    """A straight line through one signal over another: ratio of their units, and -1 to 1."""

    slope: float
    correlation: float


class Smooth(NamedTuple):
    """All parts of a recording on even grids, smoothed alike; None without a reference."""

    force: Array  # (N,) F_e [N]
    x: Array  # (N,) [m]
    v: Array  # (N,) [m/s]
    a: Array  # (N,) [m/s^2]
    reference: Array | None  # (4, N) x_r [m], its recorded rate and acceleration, F_r [N]
    reference_rate: Array | None  # (N,) rate of x_r itself [m/s]


class Overlap(NamedTuple):
    """The time that topics have in common."""

    spans: dict[str, tuple[float, float]]  # first and last stamp of each topic [s]
    seconds: float
    enough: bool  # most of the shorter one of wrench and joints

    @property
    def text(self) -> str:
        """Begin and end of each topic."""
        return ', '.join(f'{name} from {begin:.6g} to {end:.6g} s'
                         for name, (begin, end) in self.spans.items())


class Lag(NamedTuple):
    """The shift at which the force fits the motion best."""

    seconds: float  # positive if the force comes late
    correlation: float  # there
    unshifted: float  # the largest magnitude of a correlation without a shift


class Early(NamedTuple):
    """By how much the robot is ahead of its reference."""

    seconds: float  # shift of the reference at which eq. (1) holds best, >= 0
    left: float  # the squared misfit of eq. (1) there, of that without a shift


class Onset(NamedTuple):
    """The first sign of a contact in the force."""

    position: float  # median over the contacts [m]
    depth: float  # from there to the deepest positions [m]
    blur: float  # travel within the smoothing, by which both are uncertain [m]


def line_through(x: Array, y: Array) -> Line:
    """Fit a straight line to y over x, in any units."""
    x, y = x - np.mean(x), y - np.mean(y)
    square = max(float(x @ x), 1e-300)
    product = float(x @ y)
    return Line(product / square, product / max(float(np.sqrt(square * (y @ y))), 1e-300))


def bend_of(t: Array, x: Array) -> float:
    """
    Return how far a motion x [m] over t [s] departs from one stroke at constant speed.

    It is the standard deviation from a straight line in time, over the range, or from one over the
    position, over the duration, if that is larger: as in a rest after a step.
    """
    return max(_deviation(t, x), _deviation(x, t))


def _deviation(x: Array, y: Array) -> float:
    """Return the standard deviation of y from a line over x, over its range."""
    return float(np.std(y - line_through(x, y).slope * x)) / max(float(np.ptp(y)), 1e-300)
