# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Publishers of estimates and reference, which send serialised messages."""

from math import nan
from operator import attrgetter
from typing import Any, Callable, Sequence

from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile

from .topics import (
    FLOAT64, message_class, OUTPUT_QOS, overridable, REFERENCE, STATUS_QOS, STRING, TRAJECTORY,
    VECTOR3, WRENCH_TYPE)
from ..estimators.stiffness_matrix import MatrixEstimate
from ..pipeline.arm_outputs import CompensatedWrench, TargetPose
from ..pipeline.axes import encode_matrices, MATRIX_TOPICS, Result
from ..pipeline.wall_law import WallLawNews
from ..recordings.encoding import (
    encode_float64, encode_string, TrajectoryEncoder, Vector3StampedEncoder, WrenchEncoder)

_ALWAYS: dict[str, Callable[[Any], float]] = {
    name: attrgetter(name) for name in ('stiffness', 'damping')}
_ON_DEMAND: dict[str, Callable[[Any], float]] = {
    name: attrgetter(name) for name in ('stiffness_std', 'damping_std', 'location', 'inertia')}


class EstimatePublishers:
    """All outputs of the estimator node; without `compensated` no `~/compensated_wrench`."""

    def __init__(self, node: Node, joint: str) -> None:
        self._joint = joint or 'contact_axis'
        self.compensated: CompensatedWrench | None = None

        def publisher(type_name: str, topic: str, qos: QoSProfile = OUTPUT_QOS) -> Publisher:
            return node.create_publisher(
                message_class(type_name), topic, qos, qos_overriding_options=overridable())

        self._publishers = {name: publisher(VECTOR3, f'~/{name}')
                            for name in (*_ALWAYS, *_ON_DEMAND)}
        self._publishers['model_fit'] = node.create_publisher(
            message_class(FLOAT64), '~/model_fit', OUTPUT_QOS)
        self._reference = publisher(TRAJECTORY, REFERENCE)
        self._status = publisher(STRING, '~/status', STATUS_QOS)
        self._law, self._news = publisher(STRING, '~/wall_law', STATUS_QOS), WallLawNews()
        self._stability = publisher(FLOAT64, '~/stability')
        self._pose = node.create_publisher(PoseStamped, '~/target_pose', OUTPUT_QOS)
        self._of_contact = node.create_publisher(
            message_class(WRENCH_TYPE), '~/compensated_wrench', OUTPUT_QOS)
        self._matrices = {
            name: node.create_publisher(message_class(type_name), f'~/{name}', OUTPUT_QOS)
            for name, type_name in MATRIX_TOPICS.items()
        }
        self._wanted: list[tuple[Any, Callable[[Any], float]]] = []
        self._last_status: tuple[str, str] | None = None
        self._places = [0]
        self.look_for_subscribers()

    def use(self, frame_id: str, axes: str) -> None:
        """Set the frame and the axes of all outputs."""
        self.frame_id, self._further_axes = frame_id, axes[1:]
        self._places = ['xyz'.index(axis) for axis in axes]
        self._vectors = Vector3StampedEncoder(frame_id)
        self._wrenches = WrenchEncoder(frame_id)
        self._trajectories = TrajectoryEncoder(frame_id, self._joint)

    def look_for_subscribers(self) -> None:
        """Find the optional topics that have subscribers; too slow for every sample."""
        wanted = [(self._publishers[name], get) for name, get in _ALWAYS.items()]
        for name, get in _ON_DEMAND.items():
            if self._publishers[name].get_subscription_count() > 0:
                wanted.append((self._publishers[name], get))
        self._wanted = wanted
        self._wrench_wanted = self._of_contact.get_subscription_count() > 0
        self._fit_wanted = self._publishers['model_fit'].get_subscription_count() > 0

    def publish(self, result: Result) -> None:
        """Publish one result."""
        estimate, stamp_ns = result.estimates[0], result.sample.stamp_ns
        reference = result.reference
        if reference is not None:
            # Published first: the robot waits for it.
            self._reference.publish(
                self._trajectories.encode(result.reference_stamp_ns, *reference))
        encode, places = self._vectors.encode, self._places
        for publisher, get in self._wanted:
            vector = [nan, nan, nan]
            for place, of_axis in zip(places, result.estimates):
                vector[place] = get(of_axis)
            publisher.publish(encode(stamp_ns, *vector))
        if self._fit_wanted:
            self._publishers['model_fit'].publish(encode_float64(estimate.model_fit))
        if self._wrench_wanted and self.compensated is not None and result.arm is not None:
            self._of_contact.publish(
                self._wrenches.encode(stamp_ns, *self.compensated.take(stamp_ns, result.arm)))
        self.publish_status(estimate.status.value, self._reason(result))

    def publish_matrices(self, estimate: MatrixEstimate) -> None:
        """Publish stiffness and damping of three coupled axes."""
        for name, raw in encode_matrices(estimate, self._vectors).items():
            self._matrices[name].publish(raw)

    def _reason(self, result: Result) -> str:
        """Return the reason of the status, and the status of the further axes."""
        estimate, *further = result.estimates
        if not further:
            return estimate.reason
        others = ', '.join(
            f'{axis} {other.status.value}' + (f' ({other.reason})' if other.reason else '')
            for axis, other in zip(self._further_axes, further))
        return f'{estimate.reason}; {others}' if estimate.reason else others

    def publish_status(self, status: str, reason: str) -> None:
        """Publish the status where it differs from the last one."""
        if (status, reason) != self._last_status:
            self._last_status = (status, reason)
            self._status.publish(encode_string(f'{status}: {reason}' if reason else status))

    def publish_law(self, probabilities: Sequence[float]) -> None:
        """Publish the laws of the contact where they differ notably from the last ones."""
        text = self._news.take(probabilities)
        if text:
            self._law.publish(encode_string(text))

    def publish_stability(self, margin: float) -> None:
        """Publish the phase margin of the robot on the wall [deg]."""
        self._stability.publish(encode_float64(margin))

    def publish_pose(self, pose: TargetPose, base: str) -> None:
        """Publish the target of an arm."""
        message = PoseStamped()
        stamp, target = message.header.stamp, message.pose
        stamp.sec, stamp.nanosec = divmod(pose.stamp_ns, 1_000_000_000)
        message.header.frame_id = base
        target.position.x, target.position.y, target.position.z = pose.position
        turn = target.orientation
        turn.x, turn.y, turn.z, turn.w = pose.quaternion
        self._pose.publish(message)
