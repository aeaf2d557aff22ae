# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rest-to-rest motion with continuous acceleration."""

from __future__ import annotations


def quintic(start: float, end: float, duration: float, t: float) -> tuple[float, float, float]:
    """
    Evaluate the fifth-order polynomial from rest to rest.

    start, end: positions [m]
    duration: duration of the motion [s], > 0
    t: time since the start [s]; clipped to [0, duration]
    Returns position, velocity, acceleration: in [m], [m/s], [m/s^2]
    """
    s = min(max(t / duration, 0.0), 1.0)
    span = end - start
    return (
        start + span * s**3 * (10.0 - 15.0 * s + 6.0 * s * s),
        span / duration * 30.0 * s * s * (1.0 - s) ** 2,
        span / duration**2 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s),
    )
