# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Real-time simulation of robot, wall and sensors in an experiment."""

from collections import deque
import json
from pathlib import Path
from threading import Thread
import time
from typing import Any, Mapping, Sequence

from rclpy.node import Node

from . import topics
from .data_thread import RawSubscriptions
from .parameters import declare, serve_changes
from .plant_statistics import PlantStatistics
from .running import run_node
from .topics import message_class
from ..exceptions import MessageError, ParameterRangeError
from ..parameters import build, changed, divided, ParameterSpecification, specifications
from ..plant.closed_loop import extrapolate, Sensors
from ..plant.plant_parameters import PlantNodeParameters, PlantParameters
from ..plant.world import World
from ..recordings.decoding import TrajectoryDecoder
from ..recordings.encoding import JointStateEncoder, TrajectoryEncoder, WrenchEncoder
from ..reference.experiments import experiment_named
from ..reference.setpoints import Reference

PURPOSE = 'plant_node: simulate robot, wall and sensors, and play an experiment on them'
_SETTLING_S = 0.5  # a publisher may see a match before the subscriber does
_STALE_S = 0.1  # the robot then stops, as with controllers whose stream of setpoints ends
_LOCKSTEP_TIMEOUT_NS = 1_000_000_000  # then the sample counts as dropped


def all_specifications() -> list[ParameterSpecification]:
    """Return the specifications of the node's parameters."""
    return [*specifications(PlantParameters), *specifications(PlantNodeParameters)]


class PlantNode(Node):
    """The simulated world on a clock: sample k is stamped exactly t0 + k T and sent then."""

    def __init__(self) -> None:
        super().__init__('plant_node')
        world, own = divided(PlantNodeParameters, declare(self, all_specifications()))
        self._plant = build(PlantParameters, world)
        self._own = build(PlantNodeParameters, own)
        if self._plant.robot.control != 'impedance':  # no topic carries the force that would push
            raise ParameterRangeError(
                f'robot.control must be impedance in plant_node, got {self._plant.robot.control}; '
                'a bare arm runs off-line only, in run_closed_loop and in `reproduce`')
        experiment = experiment_named(self._own.experiment)
        self._duration = self._own.duration or (
            float('inf') if self._own.repeat else experiment.duration)
        self._experiment = experiment.cyclic() if self._own.repeat else experiment
        start = experiment.desired(0.0).position
        self._world, self._sensors = World(self._plant, start), Sensors(self._plant)
        self._reference = Reference(start, 0.0, 0.0, 0.0)
        self._followed_since = 0.0
        self._waiting: deque[tuple[int, Reference]] = deque(maxlen=1000)
        self._period_ns = round(1e9 / self._plant.sample_rate)
        self.statistics = PlantStatistics(self._period_ns)
        self._connect()
        serve_changes(self, all_specifications(), self._change_parameters)
        self._stopping = False
        self._thread = Thread(target=self._run, name='plant', daemon=True)

    def _connect(self) -> None:
        own = self._own
        self._wrenches = WrenchEncoder(own.frame_id)
        self._joint_states = JointStateEncoder(
            own.frame_id, own.joint, self._plant.sensors.publish_velocity)
        self._setpoints = TrajectoryEncoder(own.frame_id, own.joint)
        self._references = TrajectoryDecoder()

        def publisher(type_name: str, topic: str) -> Any:
            return self.create_publisher(message_class(type_name), topic, topics.OUTPUT_QOS)

        self._wrench_publisher = publisher('geometry_msgs/msg/WrenchStamped', topics.WRENCH)
        self._joint_publisher = publisher('sensor_msgs/msg/JointState', topics.JOINT_STATES)
        self._setpoint_publisher = publisher(topics.TRAJECTORY, topics.DESIRED)
        self._data = RawSubscriptions(self)
        self._data.subscribe(
            topics.REFERENCE, topics.TRAJECTORY, topics.INPUT_QOS, self._on_reference)

    def start(self) -> None:
        """Start the simulation when a subscriber is there."""
        self._thread.start()

    def stop(self) -> None:
        """Stop the simulation and write the summary."""
        self._stopping = True
        if self._thread.is_alive():
            self._thread.join()
        if self._own.summary_file:
            Path(self._own.summary_file).write_text(json.dumps(self.statistics.summary()))

    @property
    def finished(self) -> bool:
        """Whether the duration is over."""
        return self._thread.ident is not None and not self._thread.is_alive()

    # -- the clock --------------------------------------------------------------------------

    def _run(self) -> None:
        self._wait_for_subscribers()
        begin_ns, begin = time.time_ns(), time.perf_counter_ns()
        self.statistics.begin_ns = begin_ns
        for k in range(round(min(self._duration * self._plant.sample_rate, 2**62))):
            self._wait_until(begin + k * self._period_ns)
            if self._own.lockstep:
                self._wait_for_answer(k - 1)
            if self._stopping:
                return
            self._send(k, begin_ns + k * self._period_ns)
            self._follow_newest(begin_ns, k)
            follow = extrapolate(self._followed_since, self._reference)
            self._world.advance(self._period_ns * 1e-9, follow)
        self._wait_until(time.perf_counter_ns() + 50_000_000)  # the last references

    def _wait_for_subscribers(self) -> None:
        give_up = time.monotonic() + self._own.patience_s
        publishers = (self._wrench_publisher, self._joint_publisher)
        while time.monotonic() < give_up and not self._stopping:
            if all(p.get_subscription_count() >= self._own.subscribers for p in publishers):
                break
            self._idle(0.02)
        self._idle(_SETTLING_S)

    def _wait_for_answer(self, k: int) -> None:
        """Wait for the reference that answers sample k."""
        give_up = time.perf_counter_ns() + _LOCKSTEP_TIMEOUT_NS
        while not (self._stopping or self.statistics.has_answer(k)):
            remaining = give_up - time.perf_counter_ns()
            if remaining <= 0:
                return
            self._receive(remaining)

    def _idle(self, seconds: float) -> None:
        self._wait_until(time.perf_counter_ns() + int(seconds * 1e9))

    def _wait_until(self, deadline_ns: int) -> None:
        """Receive references while waiting."""
        while not self._stopping:
            remaining = deadline_ns - time.perf_counter_ns()
            if remaining <= 0:
                return
            self._receive(remaining)

    def _receive(self, timeout_ns: int) -> None:
        """Wait for references, but only briefly: the node may have to stop."""
        if self._data.dedicated:
            self._data.wait(min(timeout_ns, 100_000_000))
        else:  # the executor receives them in a thread of its own
            time.sleep(min(timeout_ns, 1_000_000) * 1e-9)

    def _send(self, k: int, stamp_ns: int) -> None:
        """Publish sample k, its setpoint first, since the reference depends on it."""
        truth = self._world.truth(extrapolate(self._followed_since, self._reference))
        force, position, velocity = self._sensors.measure(truth)
        period = self._period_ns * 1e-9
        setpoint = self._experiment.desired((k + 1) * period)
        setpoint_stamp_ns = stamp_ns + self._period_ns
        self._setpoint_publisher.publish(self._setpoints.encode(setpoint_stamp_ns, *setpoint))
        self._joint_publisher.publish(self._joint_states.encode(stamp_ns, position, velocity))
        self.statistics.sent(k, truth.force)
        self._wrench_publisher.publish(self._wrenches.encode(stamp_ns, force, 0.0, 0.0))

    def _on_reference(self, raw: bytes) -> None:
        try:
            stamp_ns, *point = self._references.decode(raw)
        except MessageError:
            self.statistics.unusable += 1
            return
        self.statistics.answered(stamp_ns)
        x, v, a, effort = (0.0 if value != value else value for value in point)
        self._waiting.append((stamp_ns, Reference(x, v, a, effort)))

    def _follow_newest(self, begin_ns: int, k: int) -> None:
        """Follow the newest reference that is due."""
        now_ns = begin_ns + k * self._period_ns
        while self._waiting and self._waiting[0][0] <= now_ns:
            stamp_ns, self._reference = self._waiting.popleft()
            self._followed_since = (stamp_ns - begin_ns) * 1e-9
        now = k * self._period_ns * 1e-9
        if now - self._followed_since > _STALE_S:
            position, _, _, force = extrapolate(self._followed_since, self._reference)(now)
            self._reference, self._followed_since = Reference(position, 0.0, 0.0, force), now

    # -- parameters -------------------------------------------------------------------------

    def _change_parameters(self, changes: Mapping[str, Any]) -> None:
        world, own = divided(PlantNodeParameters, changes)
        changed(self._own, own)
        self._plant = changed(self._plant, world)
        self._world.configure(self._plant)
        self._sensors.configure(self._plant)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until its experiment is over or it is interrupted."""
    return run_node(PlantNode, PURPOSE, all_specifications(), args)
