# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A driver in simulation: publishes a recorded run in real time, stamped as it is published."""

from __future__ import annotations

from struct import Struct
import time

import rclpy
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, ReliabilityPolicy

from ..recordings import RecordingReader
from ..ros import topics
from ..ros.topics import message_class

# Sensor drivers are best effort; a description is latched.
_SENSOR_QOS = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
_STAMP = Struct('<iI')
_STAMP_AT = 4  # behind the encapsulation
_DISCOVERY_S = 5.0


class PlayerNode(Node):
    """Publishers of all topics of a recording."""

    def __init__(self) -> None:
        super().__init__('player_node')
        path = self.declare_parameter('recording', '').value
        self._reader = RecordingReader(path)
        self._own: dict[str, Publisher] = {}
        for topic, type_name in self._reader.topics().items():
            latched = topic.endswith(topics.ROBOT_DESCRIPTION)
            self._own[topic] = self.create_publisher(
                message_class(type_name), topic,
                topics.DESCRIPTION_QOS if latched else _SENSOR_QOS)

    def play(self) -> None:
        """Publish every message at its time after the first."""
        begin_ns, start_ns = self._reader.start_ns or 0, time.time_ns()
        for message in self._reader.messages():
            publish = self._own[message.topic].publish
            if message.topic.endswith(topics.ROBOT_DESCRIPTION):
                publish(message.data)
                time.sleep(_DISCOVERY_S)
                start_ns = time.time_ns()
                continue
            due_ns = start_ns + message.log_time_ns - begin_ns
            wait_ns = due_ns - time.time_ns()
            if wait_ns > 0:
                time.sleep(1e-9 * wait_ns)
            raw = bytearray(message.data)
            _STAMP.pack_into(raw, _STAMP_AT, *divmod(due_ns, 1_000_000_000))
            publish(bytes(raw))


def main() -> int:
    """Publish the recording once."""
    rclpy.init()
    try:
        PlayerNode().play()
        time.sleep(1.0)
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == '__main__':
    raise SystemExit(main())
