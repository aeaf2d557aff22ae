# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimator node's subscriptions about its arm: the description, and the transforms of tf."""

from threading import Lock
from typing import Callable

from rclpy.node import Node
from std_msgs.msg import String

from . import topics
from .data_thread import RawSubscriptions
from .topics import has_transforms
from ..exceptions import ContactEstimationError, MissingPackageError
from ..kinematics.contact_kinematics import ContactKinematics
from ..kinematics.description import turning_joint
from ..kinematics.frame_tree import TRANSFORMS_TYPE
from ..kinematics.transform_model import TransformModel
from ..pipeline.arm_inputs import ArmStage
from ..pipeline.arm_kinematics import NO_DESCRIPTION, NOT_INSTALLED
from ..pipeline.events import DESCRIPTION, EstimationEvent, event_now
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


CHANGED = 'robot_description_changed'


class ArmTopics:
    """Subscriptions that tell a session about its arm."""

    def __init__(
        self, node: Node, session: ContactSession, stage: ArmStage, lock: Lock,
        publish: Callable[[EstimationEvent], None],
    ) -> None:
        self._node, self._session, self._stage = node, session, stage
        self._lock, self._publish = lock, publish
        self._said: ContactKinematics | None = None
        if session.arm is not None:
            self._describe(session.description)

    def subscribe(self, data: RawSubscriptions, on_motion: Callable[[bytes], None]) -> None:
        """Subscribe to the description, where it is missing, and to tf, where it is installed."""
        of_poses = self._session.parameters.pose_source == 'tf'
        installed = has_transforms()
        if of_poses and not installed:
            raise MissingPackageError(f'pose_source tf: {NOT_INSTALLED}')
        if installed:
            data.subscribe(topics.TF_STATIC, TRANSFORMS_TYPE, topics.TF_STATIC_QOS,
                           self._on_static, wakes=False, overrides=True)
        else:
            self._stage.frames.unreadable = NOT_INSTALLED
        if of_poses:
            data.subscribe(topics.TF, TRANSFORMS_TYPE, topics.INPUT_QOS, on_motion, overrides=True)
        if self._session.problem == NO_DESCRIPTION:
            topic = topics.ROBOT_DESCRIPTION
            self._node.create_subscription(
                String, topic, self._on_description, topics.DESCRIPTION_QOS)
            self._node.get_logger().info(
                f'waiting for the robot description on {self._node.resolve_topic_name(topic)}')

    @property
    def has_news(self) -> bool:
        """Whether something has become known that is not announced yet."""
        return bool(self._stage.events) or self._session.arm is not self._said

    def announce(self) -> None:
        """Publish and log what has become known."""
        for event in self._stage.events:
            self._publish(event)
        self._stage.events.clear()
        arm = self._session.arm
        if arm is not self._said and arm is not None:
            self._said = arm
            moving = 'frames of tf' if isinstance(arm.model, TransformModel) else 'joints'
            self._node.get_logger().info(
                f'arm from {arm.model.base} to {arm.model.tip}: {moving} '
                f'{", ".join(arm.model.joint_names)}')

    def _on_static(self, raw: bytes) -> None:
        with self._lock:
            self._stage.process_static_transforms(raw)
            self.announce()

    def _on_description(self, message: String) -> None:
        session = self._session
        with self._lock:
            if session.arm is not None:
                self._compare(message.data)
                return
            try:
                session.describe(message.data)
            except ContactEstimationError as error:
                session.problem = str(error)
                self._node.get_logger().error(str(error))
                return
            if session.arm is not None:  # an empty text describes nothing
                self._describe(message.data)

    def _compare(self, description: str) -> None:
        """Warn of another description: it is another robot, for which the node starts again."""
        if description == self._session.description:
            self._session.notices.pop(CHANGED, None)
            return
        topic = self._node.resolve_topic_name(topics.ROBOT_DESCRIPTION)
        self._session.notices[CHANGED] = (
            f'the robot description on {topic} has changed and is not used; start the node again '
            'to use it')

    def _describe(self, description: str) -> None:
        """Keep the description among the events, for replay."""
        self._publish(event_now(self._session, DESCRIPTION, {'text': description}))
        self.announce()
