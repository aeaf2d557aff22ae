# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A sampled reference, interpolated linearly or held."""

from __future__ import annotations

import bisect

import numpy as np
from numpy.typing import NDArray

from ..exceptions import SignalShapeError
from ..reference.setpoints import Reference, ReferenceAt

Array = NDArray[np.float64]


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
