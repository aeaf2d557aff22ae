# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Joint states of a whole arm, with efforts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .cdr import CdrCursor, malformed, NS_PER_S

Array = NDArray[np.float64]


class ArmReading(NamedTuple):
    """One message of sensor_msgs/msg/JointState."""

    stamp_ns: int  # of its header
    names: tuple[str, ...]  # the joints
    # position, velocity, effort: as published: empty where the publisher leaves them out
    position: Array
    velocity: Array
    effort: Array


def decode_arm(raw: bytes) -> ArmReading:
    """Read sensor_msgs/msg/JointState with all joints."""
    try:
        cursor = CdrCursor(raw)
        order = cursor.byte_order
        sec, nanosec = (int(np.frombuffer(raw, order + kind, 1, cursor.skip(4, 4))[0])
                        for kind in ('i4', 'u4'))
        cursor.text()  # frame
        names = tuple(cursor.texts())
        arrays = []
        for _ in range(3):
            places = cursor.doubles()
            arrays.append(np.frombuffer(raw, order + 'f8', len(places), places.start)
                          if len(places) else np.zeros(0))
        cursor.finish()
    except ValueError as error:
        raise malformed(raw, 'sensor_msgs/msg/JointState', error) from error
    return ArmReading(sec * NS_PER_S + nanosec, names, *arrays)
