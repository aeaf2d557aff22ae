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

"""What the checks measure of a recording."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STRAIGHT = 0.03
"""Bend, see `bend_of`, of one stroke at constant speed, at most."""


class Line(NamedTuple):
    """
    A straight line through one signal over another.

    Attributes
    ----------
    slope : float
        Ratio of their units.
    correlation : float
        -1 to 1.

    """

    slope: float
    correlation: float


class Smooth(NamedTuple):
    """
    All parts of a recording on even grids, smoothed alike.

    Attributes
    ----------
    force : ndarray, shape (N,)
        F_e [N].
    x, v, a : ndarray, shape (N,)
        Position and its derivatives [m], [m/s], [m/s^2].
    reference : ndarray, shape (4, N), or None
        x_r [m], its recorded rate and acceleration, F_r [N].
    reference_rate : ndarray, shape (N,), or None
        Rate of the recorded x_r itself [m/s].

    """

    force: Array
    x: Array
    v: Array
    a: Array
    reference: Array | None
    reference_rate: Array | None


class Overlap(NamedTuple):
    """
    The time that topics have in common.

    Attributes
    ----------
    spans : dict of str to (float, float)
        First and last stamp of each topic [s].
    seconds : float
        In common [s].
    enough : bool
        Whether that is most of the shorter one of wrench and joints.

    """

    spans: dict[str, tuple[float, float]]
    seconds: float
    enough: bool

    @property
    def text(self) -> str:
        """Begin and end of each topic."""
        return ', '.join(f'{name} from {begin:.6g} to {end:.6g} s'
                         for name, (begin, end) in self.spans.items())


class Lag(NamedTuple):
    """
    The shift at which the force fits the motion best.

    Attributes
    ----------
    seconds : float
        Positive if the force comes late.
    correlation : float
        There.
    unshifted : float
        The largest magnitude of a correlation without a shift.

    """

    seconds: float
    correlation: float
    unshifted: float


class Early(NamedTuple):
    """
    By how much the robot is ahead of its reference.

    Attributes
    ----------
    seconds : float
        Shift of the reference at which eq. (1) holds best, >= 0.
    left : float
        The squared misfit of eq. (1) there, of that without a shift.

    """

    seconds: float
    left: float


class Onset(NamedTuple):
    """
    The first sign of a contact in the force.

    Attributes
    ----------
    position : float
        Median over the contacts [m].
    depth : float
        From there to the deepest positions [m].
    blur : float
        Travel within the smoothing, by which both are uncertain [m].

    """

    position: float
    depth: float
    blur: float


def line_through(x: Array, y: Array) -> Line:
    """
    Fit a straight line.

    Parameters
    ----------
    x, y : ndarray, shape (N,)
        Any units.

    Returns
    -------
    line : Line
        Slope of y over x.

    """
    x, y = x - np.mean(x), y - np.mean(y)
    square = max(float(x @ x), 1e-300)
    product = float(x @ y)
    return Line(product / square, product / max(float(np.sqrt(square * (y @ y))), 1e-300))


def bend_of(t: Array, x: Array) -> float:
    """
    Return how far a motion departs from one stroke at constant speed.

    Parameters
    ----------
    t, x : ndarray, shape (N,)
        Time [s] and position [m].

    Returns
    -------
    bend : float
        Standard deviation from a straight line in time, over the range, or from one over the
        position, over the duration, if that is larger: as in a rest after a step.

    """
    return max(_deviation(t, x), _deviation(x, t))


def _deviation(x: Array, y: Array) -> float:
    """Return the standard deviation of y from a line over x, over its range."""
    return float(np.std(y - line_through(x, y).slope * x)) / max(float(np.ptp(y)), 1e-300)
