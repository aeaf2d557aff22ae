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

"""
How a force goes on between its samples.

Straight lines are what a reader expects; a force that a sensor samples is smooth, and one that a
digital controller puts out is held until the next. Taking one for the other looks like a lag or
a delay of half a sample. Each is given as samples whose straight lines have the true areas.
"""

from __future__ import annotations

from math import sqrt
from typing import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]

_AHEAD, _HERE = 11.0 / 60.0, 1.0 - 22.0 / 60.0  # weights of neighbours and middle
_POLE = (sqrt(_HERE**2 - 4.0 * _AHEAD**2) - _HERE) / (2.0 * _AHEAD)
_GAIN = -_POLE / _AHEAD


def straight(force: Array) -> Array:
    """
    Leave samples as they are.

    Parameters
    ----------
    force : ndarray, shape (N,)
        Measured.

    Returns
    -------
    samples : ndarray, shape (N,)
        In the same unit.

    """
    return force


def smooth(force: Array) -> Array:
    """Follow the smooth curve through all samples; parameters as `straight`."""
    # A tone's area over an interval is tan(u) / u times that under the line, u = omega h / 2. With
    # q = sin(u)^2, which is -1/4 of the second difference, it is 1 + q / 3 / (1 - 11 q / 15) to a
    # hundredth for four samples a period or more (a compact scheme, Lele 1992).
    bend = np.zeros(len(force))
    bend[1:-1] = np.diff(force, 2) / -12.0
    forward = lfilter([_GAIN], [1.0, -_POLE], bend)
    return force + np.asarray(lfilter([1.0], [1.0, -_POLE], forward[::-1])[::-1])


def held(force: Array) -> Array:
    """Hold each sample until the next; parameters as `straight`."""
    # The line through the middles of the steps, half a sample late.
    late = force.copy()
    late[1:] = 0.5 * (force[1:] + force[:-1])
    return late


BETWEEN: dict[str, Callable[[Array], Array]] = {
    'straight': straight, 'smooth': smooth, 'held': held,
}
"""What may happen between samples, by name, the likeliest first."""

NOISE = {'straight': (1.0,), 'smooth': (-1.0 / 12.0, 7.0 / 6.0, -1.0 / 12.0), 'held': (0.5, 0.5)}
"""Weights with which each passes on white noise of the samples, `smooth` to first order."""
