# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The zero of the force in a recording: its level in free flight."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..exceptions import RecordingError

Array = NDArray[np.float64]

FIRST = 'first-free-flight'
_WINDOW_S = 0.5  # of free flight, as a tare on line needs
_QUIET = 3.0  # times the noise between samples
_MAD = 0.6745  # of the standard deviation, for normal noise


class Tare(NamedTuple):
    """Force taken as zero [N], and the span of its median [s from the first wrench]."""

    force: float
    begin_s: float
    end_s: float

    def __str__(self) -> str:
        """Return what was done."""
        return (f'tare: {self.force:.4g} N subtracted from the force, its median from '
                f'{self.begin_s:.4g} to {self.end_s:.4g} s')


def tare_of(t: Array, force: Array, tare: str) -> Tare:
    """Measure the zero of the force [N] over `tare`, a span A:B [s] or FIRST."""
    if tare == FIRST:
        begin, end = _first_free_flight(t, force)
    else:
        match = re.fullmatch(r'([\d.]*):([\d.]*)', tare)
        try:
            begin, end = (float(part) if part else edge for part, edge in zip(
                match.groups() if match else ('?', '?'), (0.0, float(t[-1]))))
        except ValueError as error:
            raise RecordingError(
                f'--tare must be {FIRST}, tracked, or a span of free flight A:B in seconds from '
                f'the first wrench, got {tare!r}; example: 0.2:1.5') from error
    inside = (t >= begin) & (t <= end)
    if not inside.any():
        raise RecordingError(
            f'--tare {tare}: no wrench from {begin:g} to {end:g} s; the recording lasts '
            f'{t[-1]:.4g} s')
    return Tare(float(np.median(force[inside])), begin, end)


def _first_free_flight(t: Array, force: Array) -> tuple[float, float]:
    """
    Find the first windows in which the force is quiet, and presses less than half as it can.

    F_e is negative while pressing: free flight is the upper of two levels, even where zero steps.
    """
    edges = np.searchsorted(t, np.arange(0.0, t[-1], _WINDOW_S))
    windows = [(int(a), int(b)) for a, b in zip(edges[:-1], edges[1:]) if b - a > 2]
    noise = float(np.median(np.abs(np.diff(force)))) / (_MAD * np.sqrt(2.0))
    floor = 1e-3 * float(np.ptp(force))
    means = np.array([force[a:b].mean() for a, b in windows])
    quiet = np.array([force[a:b].std() <= max(_QUIET * noise, floor) for a, b in windows], bool)
    if not quiet.any():
        raise RecordingError(
            f'--tare {FIRST} found no {_WINDOW_S:g} s in which the force is steady; give a span '
            'of free flight as --tare A:B in seconds from the first wrench')
    low, high = float(np.min(force)), float(means[quiet].max())
    free = quiet & (means > 0.5 * (low + high))
    first = int(np.argmax(free))
    last = first + int(np.argmin([*free[first:], False])) - 1
    return float(t[windows[first][0]]), float(t[windows[last][1] - 1])
