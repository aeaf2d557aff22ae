# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""On-line estimation of contact stiffness and damping, and the reference that follows from it."""

from math import nan
from threading import Lock
import time
from typing import Any, Callable, Mapping, Sequence

from diagnostic_msgs.msg import DiagnosticArray, KeyValue
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String
from std_srvs.srv import Trigger

from . import topics
from .arm_topics import ArmTopics, AxisDescription
from .data_thread import DataThread, RawSubscriptions
from .estimate_publishers import EstimatePublishers
from .estimator_diagnostics import EstimatorDiagnostics, Graph
from .estimator_node_parameters import EstimatorNodeParameters
from .parameters import declare, serve_changes
from .running import NodeLog, run_node
from ..exceptions import MessageError
from ..kinematics.parameters import JOINT_EFFORTS
from ..parameters import build, changed, divided, flatten, ParameterSpecification, specifications
from ..pipeline.arm_outputs import check_target_pose, CompensatedWrench, target_pose
from ..pipeline.axes import Result
from ..pipeline.events import (
    biases, CHANGE, EstimationEvent, event_now, LOCATION, RESET, set_location, START, TARE)
from ..pipeline.inputs import MessageInputs
from ..pipeline.parameters import EstimationParameters
from ..pipeline.session import ContactSession
from ..recordings.decoding import TrajectoryDecoder
from ..reference.setpoints import Desired
from ..reference.stable_gains import OFF, STABILITY, StabilityWatch

PURPOSE = 'estimator_node: estimate contact stiffness and damping, publish a reference trajectory'


def all_specifications() -> list[ParameterSpecification]:
    """Return the specifications of the node's parameters."""
    return [*specifications(EstimationParameters), *specifications(EstimatorNodeParameters)]


class EstimatorNode(Node):
    """
    The session between subscriptions and publishers.

    Samples are processed on the data thread; parameters, services and diagnostics on that of the
    executor. Under the lock every event falls between two samples.
    """

    finished = False

    def __init__(self) -> None:
        super().__init__('estimator_node')
        estimation, own = divided(EstimatorNodeParameters, declare(self, all_specifications()))
        self._own = build(EstimatorNodeParameters, own)
        self._session = ContactSession(build(EstimationParameters, estimation))
        self._check(self._own)
        self._lock = Lock()
        self._log = NodeLog(self)
        self._kind = CHANGE
        self._last: Result | None = None
        self._stability = StabilityWatch()
        parameters = self._session.parameters
        self._axes = ''.join(self._session.pipelines)
        self._outputs = EstimatePublishers(self, parameters.joint)
        self._outputs.compensated = CompensatedWrench(parameters)
        self._outputs.use(parameters.frame_id, self._axes)
        self._events = self.create_publisher(String, '~/events', topics.EVENTS_QOS)
        self._event(event_now(self._session, START, flatten(self._session.parameters)))
        if self._session.pipeline.limitation:
            self.get_logger().warning(self._session.pipeline.limitation)
        self._diagnostics = EstimatorDiagnostics(
            self.get_fully_qualified_name(), self._own.silence_s,
            self._hardware(parameters.frame_id), self._now_ns,
            self.resolve_topic_name(topics.ROBOT_DESCRIPTION), Graph(self).warnings)
        self._subscribe()
        self._diagnostics_publisher = self.create_publisher(
            DiagnosticArray, topics.DIAGNOSTICS, topics.OUTPUT_QOS)
        self.create_timer(1.0 / self._own.diagnostics_rate, self._report)
        self.create_service(Trigger, '~/reset', self._on_reset)
        self.create_service(Trigger, '~/tare', self._on_tare)
        self.create_service(Trigger, '~/set_location', self._on_set_location)
        serve_changes(self, all_specifications(), self._change_parameters)
        self._log.started(parameters)

    def _subscribe(self) -> None:
        self._inputs = MessageInputs(self._session)
        self._desired = TrajectoryDecoder()
        data = RawSubscriptions(self, self._own.dedicated_wait_set)
        # Served in this order: setpoint and motion of an instant precede its wrench.
        self._subscribe_raw(data, topics.DESIRED, topics.TRAJECTORY, self._on_desired, False)
        self._arm_topics: ArmTopics | None = None
        if self._inputs.arm is not None:
            self._arm_topics = ArmTopics(
                self, self._session, self._inputs.arm, self._lock, self._event)
            self._arm_topics.subscribe(data, self._on_motion)
        else:
            AxisDescription(self, self._session, self._lock)
        if self._session.parameters.pose_source != 'tf':
            self._subscribe_raw(data, topics.JOINT_STATES, topics.JOINTS_TYPE, self._on_motion)
        if self._session.parameters.wrench_source == JOINT_EFFORTS:
            self._use_frame(self._inputs.frame_id)
        else:
            self._subscribe_raw(data, topics.WRENCH, topics.WRENCH_TYPE, self._on_wrench)
        self._thread = DataThread(data, self._diagnostics.failed)

    def _subscribe_raw(
        self, data: RawSubscriptions, topic: str, type_name: str,
        callback: Callable[[bytes], None], wakes: bool = True,
    ) -> None:
        data.subscribe(topic, type_name, topics.INPUT_QOS, callback, wakes, overrides=True)

    def start(self) -> None:
        """Start the data thread."""
        self._thread.start()

    def stop(self) -> None:
        """Stop the data thread."""
        self._thread.stop()

    # -- data -------------------------------------------------------------------------------

    def _on_wrench(self, raw: bytes) -> None:
        self._diagnostics.arrived()
        with self._lock:
            results = self._inputs.process_wrench(raw)
            if self._arm_topics is not None and self._arm_topics.has_news:
                self._arm_topics.announce()
            if self._inputs.frame_id != self._outputs.frame_id:
                self._use_frame(self._inputs.frame_id)
            self._publish(results)

    def _on_motion(self, raw: bytes) -> None:
        if self._session.parameters.wrench_source == JOINT_EFFORTS:
            self._diagnostics.arrived()
        with self._lock:
            self._publish(self._inputs.process_motion(raw))
            if self._arm_topics is not None and self._arm_topics.has_news:
                self._arm_topics.announce()

    def _on_desired(self, raw: bytes) -> None:
        with self._lock:
            try:
                stamp_ns, *desired = self._desired.decode(raw)
            except MessageError as error:
                self._session.count_rejected(f'desired_{error.reason}')
                return
            self._session.add_desired(stamp_ns, Desired(*desired))

    def _publish(self, results: Sequence[Result]) -> None:
        for result in results:
            self._outputs.publish(result)
            if self._own.publish_target_pose:
                self._publish_target(result)
            self._last = result
            self._diagnostics.published(result.sample.stamp_ns)
        if results:
            self._outputs.publish_law(self._session.pipeline.posterior.known.laws)
        for matrices in self._session.matrix.take():
            self._outputs.publish_matrices(matrices)

    def _publish_target(self, result: Result) -> None:
        parameters = self._session.parameters
        pose = target_pose(result, parameters.reference.limits)
        if pose is None:
            self._session.count_rejected('target_pose_out_of_limits')
        else:
            self._outputs.publish_pose(pose, parameters.kinematics.base)

    def _use_frame(self, frame_id: str) -> None:
        self._outputs.use(frame_id, self._axes)
        self._diagnostics.hardware_id = self._hardware(frame_id)

    def _hardware(self, frame_id: str) -> str:
        return self._own.hardware_id or frame_id or self.resolve_topic_name(topics.WRENCH)

    def _now_ns(self) -> int:
        clock: Any = self.get_clock()
        return int(clock.now().nanoseconds) if clock.ros_time_is_active else time.time_ns()

    # -- events -----------------------------------------------------------------------------

    def _check(self, own: EstimatorNodeParameters) -> None:
        """Refuse parameters whose target poses would be unsafe for the robot."""
        if own.publish_target_pose:
            check_target_pose(self._session.parameters)

    def _change_parameters(self, changes: Mapping[str, Any]) -> None:
        estimation, own = divided(EstimatorNodeParameters, changes)
        with self._lock:
            new_own = changed(self._own, own)
            self._check(new_own)
            if estimation:
                self._session.change_parameters(estimation)
                self._outputs.compensated = CompensatedWrench(self._session.parameters)
                self._event(event_now(self._session, self._kind, estimation))
            self._own = new_own
            self._diagnostics.silence_s = new_own.silence_s
        if changes:
            self._log.changed(changes)

    def _on_reset(self, request: Any, response: Any) -> Any:
        self._reset()
        response.success, response.message = True, 'estimate is reset to its initial values'
        self._log.event(response.message)
        return response

    def _reset(self) -> None:
        with self._lock:
            self._session.reset()
            self._event(event_now(self._session, RESET, {}))

    def _on_tare(self, request: Any, response: Any) -> Any:
        with self._lock:
            response.success, response.message = self._session.tare()
            if response.success:
                self._event(event_now(self._session, TARE, biases(self._session)))
                self._log.event(response.message)
        return response

    def _on_set_location(self, request: Any, response: Any) -> Any:
        """Change the parameter, so that it shows the value; the change is the event."""
        with self._lock:
            response.success, response.message, changes = set_location(self._session)
        if response.success:
            self._kind = LOCATION
            try:
                (result,) = self.set_parameters(
                    [Parameter(name, value=value) for name, value in changes.items()])
            finally:
                self._kind = CHANGE
            if not result.successful:
                response.success, response.message = False, result.reason
            elif 'caution' in response.message:
                self._log.warning('set_location', response.message)
        return response

    def _event(self, event: EstimationEvent) -> None:
        self._events.publish(String(data=event.to_text()))

    def _judge_stability(self) -> None:
        """Publish the margin of the robot's gains on the wall as known now."""
        robot, pipeline = self._own.stability, self._session.pipeline
        last = self._last.estimate if self._last else None
        margin = self._stability.take(robot, *(nan,) * 4 if last is None else (
            last.stiffness, last.stiffness_std, last.damping, last.damping_std))
        if robot.kind != OFF:
            self._outputs.publish_stability(margin)
        self._session.notices.pop(STABILITY, None)
        text = self._stability.text(robot)
        if text and pipeline.contact:
            self._session.notices[STABILITY] = text

    def _report(self) -> None:
        self._outputs.look_for_subscribers()
        self._judge_stability()
        with self._lock:
            estimates = self._last.estimates if self._last else ()
            now = self.get_clock().now().to_msg()
            message = self._diagnostics.message(now, self._session, estimates)
        message.status[0].values += [
            KeyValue(key=f'stability_{name}', value=f'{value:.6g}')
            for name, value in self._stability.values.items()]
        self._diagnostics_publisher.publish(message)
        name, text = self._diagnostics.headline
        if text:
            self._log.warning(name, text)
        if estimates:
            reason = f': {estimates[0].reason}' if estimates[0].reason else ''
            self._log.state(f'{estimates[0].status.value}{reason}', estimates[0].stiffness)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until it is interrupted."""
    return run_node(EstimatorNode, PURPOSE, all_specifications(), args, topics.WRENCH)
