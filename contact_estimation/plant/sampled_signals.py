# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recorded forces and references between their samples."""

from __future__ import annotations

import bisect
from math import sqrt
from typing import Callable

import numpy as np
from numpy.typing import NDArray

from ..exceptions import SignalShapeError
from ..reference.setpoints import Reference, ReferenceAt

Array = NDArray[np.float64]

_AHEAD, _HERE = 11.0 / 60.0, 1.0 - 22.0 / 60.0  # weights of neighbours and middle
_POLE = (sqrt(_HERE**2 - 4.0 * _AHEAD**2) - _HERE) / (2.0 * _AHEAD)
_GAIN = -_POLE / _AHEAD


def straight(force: Array) -> Array:
    """Return the samples, shape (N,), of a linearly interpolated force: the force itself."""
    return force


def smooth(force: Array) -> Array:
    """Return the samples of a smooth curve through the force; parameters as `straight`."""
    # A tone's area over an interval is tan(u) / u times that under the line, u = omega h / 2. With
    # q = sin(u)^2, which is -1/4 of the second difference, it is 1 + q / 3 / (1 - 11 q / 15) to a
    # hundredth for four samples a period or more (a compact scheme, Lele 1992).
    from scipy.signal import lfilter  # slow to import, and no node needs it

    bend = np.zeros(len(force))
    bend[1:-1] = np.diff(force, 2) / -12.0
    forward = lfilter([_GAIN], [1.0, -_POLE], bend)
    return force + np.asarray(lfilter([1.0], [1.0, -_POLE], forward[::-1])[::-1])


def held(force: Array) -> Array:
    """Return the samples of a force held until the next; parameters as `straight`."""
    # The line through the centres of the steps, delayed by half a sample.
    late = force.copy()
    late[1:] = 0.5 * (force[1:] + force[:-1])
    return late


BETWEEN: dict[str, Callable[[Array], Array]] = {
    'straight': straight, 'smooth': smooth, 'held': held,
}
"""Behaviour between samples by name, the most likely first."""

NOISE = {'straight': (1.0,), 'smooth': (-1.0 / 12.0, 7.0 / 6.0, -1.0 / 12.0), 'held': (0.5, 0.5)}
"""Filter weights of each for white noise of the samples, `smooth` to first order."""


def reference_through(t: Array, rows: Array, held: bool = False) -> ReferenceAt:
    """
    Continue a reference between its samples; before the first and after the last it rests.

    t (N,): times of the samples [s], strictly increasing; N >= 1
    rows (4, N): x_r [m], its rate [m/s] and acceleration [m/s^2], F_r [N]
    held: whether each sample holds until the next; else straight lines connect them
    Returns reference_at: from time [s] to the reference
    """
    if np.ndim(t) != 1 or len(t) < 1 or np.shape(rows) != (4, len(t)):
        raise SignalShapeError(
            'a reference needs t of shape (N,) and rows of shape (4, N) with N >= 1, got '
            f'{np.shape(t)} and {np.shape(rows)}; give x_r, its rate, its acceleration and F_r'
        )
    if not np.all(np.diff(t) > 0.0):
        raise SignalShapeError(
            'the times of a reference must increase strictly, got equal or decreasing ones; '
            'sort the samples and keep one per time'
        )
    times: list[float] = t.tolist()
    points: list[tuple[float, float, float, float]] = list(zip(*rows.tolist()))
    slopes = list(zip(*((0.0 if held else 1.0) * np.diff(rows) / np.diff(t)).tolist()))
    before, after = (Reference(points[k][0], 0.0, 0.0) for k in (0, -1))
    begin, end, place = times[0], times[-1], 0

    def at(now: float) -> tuple[float, float, float, float]:
        nonlocal place
        if not begin <= now < end:
            return before if now < begin else after if now > end else points[-1]
        if not times[place] <= now < times[place + 1]:
            place = bisect.bisect_right(times, now) - 1
        since, (x, v, a, F) = now - times[place], points[place]
        x_1, v_1, a_1, F_1 = slopes[place]
        return x + since * x_1, v + since * v_1, a + since * a_1, F + since * F_1

    return at
