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

"""What a residual depends on, in words."""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np

from .residual_structure import Array, least_squares, Residual, Window

_SLOW_COSINES = 6  # half periods in the window: up to 1.5 Hz in 2 s
_LEAST_SHARE = 0.25  # of the residual's power: less does not name a cause
_OWN_PAST = 0.5  # correlation
_SMALLEST = 1e-12  # rms of a regressor without excitation


class Smell(NamedTuple):
    """
    A dependence of the residual and what it may come from.

    Attributes
    ----------
    text : str
        In words; {offset} is filled in [mm].
    regressor : callable
        From a window to an array of shape (N,) or (N, M).
    weight : float
        By which the share of the residual that the regressor takes away is multiplied.

    """

    text: str
    regressor: Callable[[Window], Array]
    weight: float = 1.0


def _velocity_sign(window: Window) -> Array:
    v = window.rows[:, 2]
    slow = 0.05 * float(np.sqrt(np.mean(v**2))) + _SMALLEST
    return np.asarray(v / (np.abs(v) + slow))


def _slow_cosines(window: Window) -> Array:
    phase = np.pi * (window.t - window.t[0]) / (window.t[-1] - window.t[0])  # (N,)
    return np.cos(np.outer(phase, np.arange(1, _SLOW_COSINES + 1)))


SMELLS = (
    Smell('changes sign with velocity: friction?', _velocity_sign),
    Smell('is constant: wall {offset:.2g} mm from environment.location?',
          lambda window: window.rows[:, 3]),
    Smell('bends with depth: stiffness not constant?', lambda window: window.rows[:, 1] ** 2),
    Smell('grows with depth times velocity: Hunt-Crossley damping?',
          lambda window: window.rows[:, 1] * window.rows[:, 2]),
    Smell('follows velocity: damping independent of depth?', lambda window: window.rows[:, 2]),
    Smell('follows acceleration: mass of the wall or of the tool beyond the sensor?',
          lambda window: window.acceleration),
    # Six regressors take away more than one would, whatever the cause.
    Smell('wanders with time: does the wall move?', _slow_cosines, 0.8),
)
"""What a residual may depend on; the one that takes away most of it is reported."""


def smell_of(window: Window, residual: Residual) -> str:
    """
    Say in words what the residual depends on.

    Parameters
    ----------
    window : Window
        Rows of contact.
    residual : Residual
        Of `fit`.

    Returns
    -------
    text : str
        Such as 'changes sign with velocity: friction?'.

    """
    y, power = window.rows[:, 0], float(residual.values @ residual.values)
    best, most = '', _LEAST_SHARE
    for smell in SMELLS:
        columns = np.column_stack([window.fitted, smell.regressor(window)])
        theta = least_squares(columns, y)
        left = y - columns @ theta
        share = smell.weight * (1.0 - float(left @ left) / power)
        if share > most:
            best, most = smell.text, share
    if best:
        return best.format(offset=1e3 * _offset(window))
    if _remembers(residual.values):
        return 'depends on its own past:'
    return 'is noise: vibration, or a position worse than contact.position_noise?'


def _offset(window: Window) -> float:
    """Return the shift of the wall with which a spring and damper fits best [m]."""
    K, _, c = least_squares(window.rows[:, 1:4], window.rows[:, 0]).tolist()
    return -c / K if K else 0.0


def _remembers(values: Array) -> bool:
    """Return whether a residual is correlated over a twentieth of the window."""
    step, power = max(1, len(values) // 20), float(values @ values)
    return power > 0.0 and float(values[step:] @ values[:-step]) > _OWN_PAST * power
