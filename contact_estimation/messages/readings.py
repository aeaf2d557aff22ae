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
    """
    One force measurement.

    Attributes
    ----------
    stamp_ns : int
        Header stamp [ns].
    frame_id : str
        Frame in which the force is expressed.
    force_x, force_y, force_z : float
        Force [N].

    """

    stamp_ns: int
    frame_id: str
    force_x: float
    force_y: float
    force_z: float


class JointReading(NamedTuple):
    """
    Position and velocity of one joint.

    Attributes
    ----------
    stamp_ns : int
        Header stamp [ns].
    position : float
        Position [m].
    velocity : float
        Velocity [m/s], NaN where the message has none.

    """

    stamp_ns: int
    position: float
    velocity: float


class TrajectoryReading(NamedTuple):
    """
    First point of a trajectory for one joint.

    Attributes
    ----------
    stamp_ns : int
        Header stamp [ns].
    position : float
        Position [m].
    velocity, acceleration : float
        Its derivatives [m/s], [m/s^2], NaN where the message has none.
    effort : float
        Force F_r [N], NaN where the message has none.

    """

    stamp_ns: int
    position: float
    velocity: float
    acceleration: float
    effort: float


FORCE_OF_AXIS: dict[str, Callable[[WrenchReading], float]] = {
    'x': attrgetter('force_x'),
    'y': attrgetter('force_y'),
    'z': attrgetter('force_z'),
}
"""The force along an axis of the wrench's frame."""
