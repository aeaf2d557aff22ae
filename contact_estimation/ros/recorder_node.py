# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Record the topics to MCAP; a killed process loses at most the last second."""

from dataclasses import dataclass
import time
from typing import Any, Callable, Sequence

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy

from . import topics
from .data_thread import DataThread, RawSubscriptions
from .parameters import declare
from .running import run_node
from .topics import has_transforms
from ..exceptions import ContactEstimationError, ParameterRangeError
from ..kinematics.frame_tree import TRANSFORMS_TYPE
from ..parameters import build, parameter, ParameterGroup, specifications
from ..pipeline.axes import MATRIX_TOPICS
from ..pipeline.events import EstimationEvent, START
from ..recordings import OfferedQos, RecordingWriter
from ..recordings.decoding import decode_string
from ..recordings.source import RECORD, to_metadata

PURPOSE = 'recorder_node: record wrench, joints, references and estimates as a rosbag2 folder'
_FLUSH_S, _MATCH_S = 0.4, 0.05
_DEPTH = 1000

# The estimator publishes reliably: what a busy machine drops is sent again.
_ESTIMATE_QOS = QoSProfile(depth=_DEPTH, reliability=ReliabilityPolicy.RELIABLE)
_BEST_EFFORT, _RELIABLE = ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE


class MatchedSubscriptions:
    """
    Raw subscriptions that lose nothing of reliable publishers and refuse no other.

    A best-effort subscription matches any publisher, but on a busy machine loses messages of
    reliable ones too. A reliable one gets nothing from a best-effort publisher. So each topic is
    subscribed to once its publishers are known, reliably if all of them are, and anew when the
    first comes that is not.
    """

    def __init__(
        self, node: Node, data: RawSubscriptions, caught_up: Callable[[], None], depth: int
    ) -> None:
        self._node, self._data, self._caught_up, self._depth = node, data, caught_up, depth
        self._wanted: dict[str, tuple[str, Callable[[bytes], None]]] = {}
        self._present: dict[str, Any] = {}

    def add(self, topic: str, type_name: str, callback: Callable[[bytes], None]) -> None:
        """Want a topic; parameters as of `RawSubscriptions.subscribe`."""
        self._wanted[topic] = type_name, callback

    def match(self) -> None:
        """Look for publishers; to be called again and again."""
        for topic in self._wanted:
            offered = [info.qos_profile.reliability for info in
                       self._node.get_publishers_info_by_topic(
                           self._node.resolve_topic_name(topic))]
            reliable = all(one == _RELIABLE for one in offered)
            present = self._present.get(topic)
            if present is None:
                if offered:
                    self._subscribe(topic, reliable, overrides=True)
            elif present.qos_profile.reliability == _RELIABLE and not reliable:
                self._data.forget(present)
                self._caught_up()
                self._node.destroy_subscription(present)
                self._subscribe(topic, reliable, overrides=False)

    def _subscribe(self, topic: str, reliable: bool, overrides: bool) -> None:
        type_name, callback = self._wanted[topic]
        qos = QoSProfile(depth=self._depth, reliability=_RELIABLE if reliable else _BEST_EFFORT)
        self._present[topic] = self._data.subscribe(
            topic, type_name, qos, callback, overrides=overrides)


@dataclass(frozen=True)
class RecorderParameters(ParameterGroup):
    """Output and topics of the recorder."""

    output: str = parameter('', 'Folder to write, which must not exist', read_only=True)
    estimator: str = parameter(
        'estimator_node', 'Name of the estimator node whose estimates are recorded',
        read_only=True)
    patience_s: float = parameter(
        0.0, 'Subscribe to the wrench only once the estimates can be received, or after this; a '
        'plant that waits for subscribers then waits for these, too', 's', minimum=0.0,
        read_only=True)


def recorded_topics(estimator: str) -> dict[str, tuple[str, QoSProfile | None]]:
    """List what is recorded."""
    vectors = ('stiffness', 'damping', 'stiffness_std', 'damping_std', 'location', 'inertia')
    of_any_publisher = {
        topics.DESIRED: topics.TRAJECTORY,
        topics.JOINT_STATES: topics.JOINTS_TYPE,
        topics.WRENCH: topics.WRENCH_TYPE,
        topics.REFERENCE: topics.TRAJECTORY,
        topics.DIAGNOSTICS: 'diagnostic_msgs/msg/DiagnosticArray',
        '/parameter_events': 'rcl_interfaces/msg/ParameterEvent',
    }
    of_tf = {
        topics.TF: (TRANSFORMS_TYPE, None),
        topics.TF_STATIC: (TRANSFORMS_TYPE, topics.TF_STATIC_QOS),
    }
    return {
        **(of_tf if has_transforms() else {}),
        **{topic: (type_name, None) for topic, type_name in of_any_publisher.items()},
        **{f'{estimator}/{name}': (topics.VECTOR3, _ESTIMATE_QOS) for name in vectors},
        **{f'{estimator}/{name}': (topics.FLOAT64, _ESTIMATE_QOS)
           for name in ('model_fit', 'stability')},
        **{f'{estimator}/{name}': (type_name, _ESTIMATE_QOS)
           for name, type_name in MATRIX_TOPICS.items()},
        # Published on change: what came before the recorder is still wanted.
        **{f'{estimator}/{name}': (topics.STRING, topics.EVENTS_QOS)
           for name in ('status', 'wall_law', 'events')},
    }


class RecorderNode(Node):
    """Raw subscriptions into a RecordingWriter."""

    finished = False

    def __init__(self) -> None:
        super().__init__('recorder_node')
        own = build(RecorderParameters, declare(self, specifications(RecorderParameters)))
        if not own.output:
            raise ParameterRangeError(
                'output must name a folder to be made, got an empty text; set it with '
                '--ros-args -p output:=FOLDER')
        self._writer = RecordingWriter.folder(own.output)
        self._data = RawSubscriptions(self)
        self._thread = DataThread(self._data, self._failed)
        self._matched = MatchedSubscriptions(self, self._data, self._thread.catch_up, _DEPTH)
        self._estimates, self._give_up = [], time.monotonic() + own.patience_s
        for topic, (type_name, qos) in recorded_topics(own.estimator).items():
            record = self._recording(topic, type_name, qos)
            if topic == topics.WRENCH:
                self._wrench: tuple[str, str, Callable[[bytes], None]] | None = (
                    topic, type_name, record)
            elif qos is None:
                self._matched.add(topic, type_name, record)
            else:
                subscription = self._data.subscribe(topic, type_name, qos, record)
                if qos is _ESTIMATE_QOS:
                    self._estimates.append(subscription)
        self._match()
        steady = Clock(clock_type=ClockType.STEADY_TIME)  # a simulated clock may not have begun
        self.create_timer(_MATCH_S, self._match, clock=steady)
        self.create_timer(_FLUSH_S, self._flush, clock=steady)

    def start(self) -> None:
        """Start recording."""
        self._thread.start()

    def stop(self) -> None:
        """Write the queued messages and close the recording."""
        self._thread.stop()
        if self._data.dedicated:
            self._data.take_all()
        self._writer.close()

    def _match(self) -> None:
        """Look for publishers; want the wrench when the estimates have theirs."""
        if self._wrench is not None and (
                time.monotonic() >= self._give_up
                or all(one.get_publisher_count() for one in self._estimates)):
            self._matched.add(*self._wrench)
            self._wrench = None
        self._matched.match()

    def _recording(
        self, topic: str, type_name: str, qos: QoSProfile | None
    ) -> Callable[[bytes], None]:
        name = self.resolve_topic_name(topic)
        write, is_events = self._writer.write, topic.endswith('/events')
        # The QoS that the publishers offer, so that a played bag matches every subscriber.
        latched = qos if is_events or topic == topics.TF_STATIC else None
        offered = OfferedQos.of_profile(latched or topics.OUTPUT_QOS)

        def record(raw: bytes) -> None:
            write(name, type_name, raw, time.time_ns(), qos=offered)
            if is_events:
                self._keep_start(raw)

        return record

    def _keep_start(self, raw: bytes) -> None:
        """Store the estimator's initial parameters as MCAP metadata."""
        event = EstimationEvent.from_text(decode_string(raw))
        if event.kind == START:
            self._writer.write_metadata(RECORD, to_metadata(event.parameters))

    def _flush(self) -> None:
        try:
            self._writer.flush()
        except ContactEstimationError as error:
            self._failed(error)

    def _failed(self, error: Exception) -> None:
        self.get_logger().error(f'not recorded: {error}', throttle_duration_sec=1.0)


def main(args: Sequence[str] | None = None) -> int:
    """Record until interrupted."""
    known: Any = list(specifications(RecorderParameters))
    return run_node(RecorderNode, PURPOSE, known, args, topics.WRENCH)
