# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Joint states of an arm, which may come in several messages and among other joints."""

from __future__ import annotations

from functools import partial
from typing import Sequence

from .cdr import CdrCursor, NS_PER_S, StampedReader
from ..exceptions import MessageError


class SomeJointsDecoder:
    """Read those of several joints that a sensor_msgs/msg/JointState has."""

    def __init__(self, joints: Sequence[str]) -> None:
        offsets_of = partial(_present_joint_offsets, joints)
        self._reader = StampedReader('sensor_msgs/msg/JointState', offsets_of)

    def decode(self, raw: bytes) -> tuple[int, tuple[float, ...], tuple[float, ...]]:
        """
        Read one message.

        Returns stamp_ns, positions, velocities: stamp [ns], positions [rad] or [m] and velocities
        in the order of the joints, NaN for what the message does not have
        """
        values = self._reader.read(raw)
        return values[0] * NS_PER_S + values[1], values[3::2], values[4::2]


def _present_joint_offsets(joints: Sequence[str], cursor: CdrCursor) -> list[int | None]:
    """Find position and velocity of the joints that a message has."""
    names = cursor.texts()
    position, velocity = cursor.doubles(), cursor.doubles()
    cursor.doubles()  # effort
    cursor.finish()
    places = {name: place for place, name in enumerate(names)}
    if places.keys().isdisjoint(joints):
        raise MessageError(
            'joint_unknown',
            f'none of the joints {", ".join(joints)} is in the message, which has '
            f'{", ".join(names) or "no joint names"}; check kinematics.base, kinematics.tip and '
            'the topic',
        )
    offsets: list[int | None] = []
    for joint in joints:
        place = places.get(joint, len(position))
        for values in (position, velocity):
            offsets.append(values[place] if place < len(values) else None)
    return offsets
