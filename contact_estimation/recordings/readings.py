# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Decoded messages: plain numbers, independent of any message package.

Named tuples and not frozen dataclasses: a frozen dataclass costs a microsecond more to build, and
these are built a thousand times a second.

"""

from __future__ import annotations

from operator import attrgetter
from typing import Callable, NamedTuple


class WrenchReading(NamedTuple):
    """One force measurement."""

    stamp_ns: int  # header stamp [ns]
    frame_id: str  # frame in which the force is expressed
    # force_x, force_y, force_z: force [N]
    force_x: float
    force_y: float
    force_z: float


class JointReading(NamedTuple):
    """Position and velocity of one joint."""

    stamp_ns: int  # header stamp [ns]
    position: float  # position [m]
    velocity: float  # velocity [m/s], NaN where the message has none


class TrajectoryReading(NamedTuple):
    """First point of a trajectory for one joint."""

    stamp_ns: int  # header stamp [ns]
    position: float  # position [m]
    # velocity, acceleration: its derivatives [m/s], [m/s^2], NaN where the message has none
    velocity: float
    acceleration: float
    effort: float  # force F_r [N], NaN where the message has none


FORCE_OF_AXIS: dict[str, Callable[[WrenchReading], float]] = {
    'x': attrgetter('force_x'),
    'y': attrgetter('force_y'),
    'z': attrgetter('force_z'),
}
"""The force along an axis of the wrench's frame."""
