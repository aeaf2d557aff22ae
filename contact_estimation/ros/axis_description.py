# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a robot description says about joints that are taken for contact axes."""

from __future__ import annotations

from threading import Lock

from rclpy.node import Node
from std_msgs.msg import String

from . import topics
from ..kinematics.joint_kinds import turning_joint
from ..pipeline.session import ContactSession

REVOLUTE = 'revolute_joint'


class AxisDescription:
    """Warn where a joint of the description turns, but its positions are taken for metres."""

    def __init__(self, node: Node, session: ContactSession, lock: Lock) -> None:
        self._session, self._lock = session, lock
        node.create_subscription(
            String, topics.ROBOT_DESCRIPTION, self._on_description, topics.DESCRIPTION_QOS)

    def _on_description(self, message: String) -> None:
        session = self._session
        with self._lock:
            joint = turning_joint(message.data, list(session.parameters.joints.values()))
            session.notices.pop(REVOLUTE, None)
            if joint:
                session.notices[REVOLUTE] = (
                    f'joint {joint!r} turns, says the robot description: its positions are angles '
                    'and not metres, and no estimate holds; for an arm set kinematics.base, '
                    'kinematics.tip and contact.normal')
