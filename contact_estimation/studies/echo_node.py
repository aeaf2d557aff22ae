# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Reference of the node benchmark: the cost of any rclpy node with these topics.

It uses nothing of this package's data path: rclpy converts the messages, on a standard executor.
It replies to every wrench with the last setpoint, so that the plant moves as with an estimator.
"""

from __future__ import annotations

from geometry_msgs.msg import WrenchStamped
import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from ..reference.experiment import START
from ..ros import topics


class EchoNode(Node):
    """A node with the topics of the estimator node, without estimation."""

    def __init__(self) -> None:
        super().__init__('echo_node')
        rate = self.declare_parameter('sample_rate', 500.0).value
        self._period_ns = round(1e9 / rate)
        self._points = [JointTrajectoryPoint(positions=[START])]
        for message_type, topic, callback in (
            (JointTrajectory, topics.DESIRED, self._on_desired),
            (JointState, topics.JOINT_STATES, self._on_joints),
            (WrenchStamped, topics.WRENCH, self._on_wrench),
        ):
            self.create_subscription(message_type, topic, callback, topics.INPUT_QOS)
        self._reference = self.create_publisher(
            JointTrajectory, topics.REFERENCE, topics.OUTPUT_QOS
        )

    def _on_desired(self, message: JointTrajectory) -> None:
        self._points = message.points

    def _on_joints(self, message: JointState) -> None:
        """Accept the message; only the call counts."""

    def _on_wrench(self, message: WrenchStamped) -> None:
        stamp = message.header.stamp
        due_ns = stamp.sec * 1_000_000_000 + stamp.nanosec + self._period_ns
        answer = JointTrajectory(joint_names=['contact_axis'], points=self._points)
        answer.header.frame_id = message.header.frame_id
        answer.header.stamp.sec, answer.header.stamp.nanosec = divmod(due_ns, 1_000_000_000)
        self._reference.publish(answer)


def main() -> int:
    """Run the node until it is interrupted."""
    rclpy.init()
    executor = SingleThreadedExecutor()
    try:
        executor.add_node(EchoNode())
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == '__main__':
    raise SystemExit(main())
