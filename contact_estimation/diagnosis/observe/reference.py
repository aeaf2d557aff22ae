# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
What the samples of a reference leave open: the course between setpoints, and rates.

Straight lines between setpoints are the usual assumption. A robot that holds each until the next
follows them half a period later, which looks like a delay of its command.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .signals import Recording, Signals

Array = NDArray[np.float64]

_APART = 1.0 - 1e-9  # ramps that meet must not overlap by rounding
_SMOOTH = 0.9  # of the changes of x_r, that follow another one: else it is a staircase


def with_held_reference(recording: Recording) -> Recording:
    """Let a robot hold its reference."""
    s = recording.signals
    if len(s.reference_t) < 2:
        return recording
    reference = held_at(s.wrench_t, s.reference_t, s.reference)
    return Recording(recording.name, s._replace(reference_t=s.wrench_t, reference=reference))


def held_at(t: Array, stamps: Array, values: Array) -> Array:
    """Sample values that are held from stamp to stamp."""
    periods = np.diff(stamps, prepend=stamps[0] - (stamps[1] - stamps[0]))
    width = np.minimum(periods, float(np.median(np.diff(t))))
    width[:-1] = _APART * np.minimum(width[:-1], width[1:])
    corners = np.column_stack((stamps - 0.5 * width, stamps + 0.5 * width)).ravel()
    before = np.concatenate((values[:, :1], values[:, :-1]), axis=1)
    levels = np.stack((before, values), axis=2).reshape(len(values), -1)
    return np.array([np.interp(t, corners, row) for row in levels])


def lacks_rates(signals: Signals) -> bool:
    """Return whether a reference moves smoothly but has no rates."""
    if len(signals.reference_t) < 3 or signals.reference[1:3].any():
        return False
    moves = np.diff(signals.reference[0]) != 0.0
    following = np.count_nonzero(moves[1:] & moves[:-1])
    return bool(following > _SMOOTH * np.count_nonzero(moves) > 0.0)


def with_reference_rates(recording: Recording) -> Recording:
    """Differentiate a reference that lacks its rates."""
    s = recording.signals
    if not lacks_rates(s):
        return recording
    x_r, _, _, F_r = s.reference
    rate = np.gradient(x_r, s.reference_t)
    rows = np.array([x_r, rate, np.gradient(rate, s.reference_t), F_r])
    return Recording(recording.name, s._replace(reference=rows))
