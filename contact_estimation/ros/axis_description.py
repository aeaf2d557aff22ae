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

"""What a robot description says about joints that are taken for contact axes."""

from __future__ import annotations

from threading import Lock

from rclpy.node import Node
from std_msgs.msg import String

from . import topics
from ..estimation.session import ContactSession
from ..kinematics.joint_kinds import turning_joint

REVOLUTE = 'revolute_joint'


class AxisDescription:
    """
    Warn where a joint of the description turns, but its positions are taken for metres.

    Parameters
    ----------
    node : rclpy.node.Node
        Owner of the subscription.
    session : ContactSession
        Without an arm.
    lock : threading.Lock
        Held while the session is used.

    """

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
