# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Behaviour of a recorded force between its samples.

Linear interpolation is the usual assumption, but a sampled sensor signal is smooth, and the output
of a digital controller is held until the next sample. Confusing them looks like a lag or a delay
of half a sample. Each is represented by samples whose linear interpolation has the true areas.
"""

from __future__ import annotations

from math import sqrt
from typing import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_AHEAD, _HERE = 11.0 / 60.0, 1.0 - 22.0 / 60.0  # weights of neighbours and middle
_POLE = (sqrt(_HERE**2 - 4.0 * _AHEAD**2) - _HERE) / (2.0 * _AHEAD)
_GAIN = -_POLE / _AHEAD


def straight(force: Array) -> Array:
    """
    Return the samples of a linearly interpolated force: the force itself.

    force (N,): measured force
    Returns samples (N,): samples in the same unit
    """
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
