# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
A peer of the estimator node over DDS: sensor, planner and user.

Importing this module skips a test module where there is no ROS.

"""

from itertools import count
from pathlib import Path
import time
from typing import Any, Callable, Iterable, Iterator, Mapping, Sequence

from arm_contact import instants
from contact_estimation.commands import replay
from contact_estimation.pipeline.events import EstimationEvent
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.decoding import Vector3StampedDecoder
from contact_estimation.signals.contact_sample import ContactSample
import pytest

rclpy = pytest.importorskip('rclpy')

from contact_estimation.ros.topics import EVENTS_QOS  # noqa: E402,I100
from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from geometry_msgs.msg import Vector3Stamped, WrenchStamped  # noqa: E402
from rcl_interfaces.msg import SetParametersResult  # noqa: E402
from rcl_interfaces.srv import DescribeParameters, GetParameters  # noqa: E402
from rcl_interfaces.srv import ListParameters, SetParameters  # noqa: E402
from rcl_interfaces.srv import SetParametersAtomically  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from ros_listener import DEEP_QOS, Listener  # noqa: E402
from ros_messages import joint_state, trajectory, wrench  # noqa: E402
from ros_processes import node_process  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_msgs.msg import String  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402
from trajectory_msgs.msg import JointTrajectory  # noqa: E402

PERIOD_NS = 2_000_000
WINDOW = 30  # samples under way at once: less than any queue holds
ESTIMATES = ('stiffness', 'damping')
_KNOCK_S = 0.02


def _set_request(values: Mapping[str, Any]) -> Any:
    return SetParameters.Request(parameters=[
        Parameter(name, value=value).to_parameter_msg() for name, value in values.items()])


class Peer(Listener):
    """Sensor, planner and user of one estimator node."""

    name = 'estimator_node'

    def __init__(self) -> None:
        super().__init__()
        publisher = self.node.create_publisher
        self.wrenches = publisher(WrenchStamped, 'wrench', DEEP_QOS)
        self.joints = publisher(JointState, 'joint_states', DEEP_QOS)
        self.wishes = publisher(JointTrajectory, 'desired_trajectory', DEEP_QOS)
        for name in ESTIMATES:
            self.listen(name, Vector3Stamped, f'{self.name}/{name}')
        self.listen('reference', JointTrajectory, 'reference_trajectory')
        self.listen('status', String, f'{self.name}/status')
        self.listen('wall_law', String, f'{self.name}/wall_law')
        self.listen('diagnostics', DiagnosticArray, '/diagnostics')
        self.begin_ns = 1_000_000_000_000_000
        self._changed: set[str] = set()
        self._defaults: dict[str, Any] = {}

    # -- finding each other -------------------------------------------------------------------

    def meet(self, wishes: bool = True) -> None:
        """Wait until every message passes, both ways; wishes stay in force."""
        outputs = [f'{self.name}/{name}' for name in (*ESTIMATES, 'status')]
        inputs = (self.wrenches, self.joints, self.wishes)
        self.spin_until(
            lambda: all(p.get_subscription_count() for p in inputs)
            and all(self.node.count_publishers(topic) for topic in outputs),
            'discovery')
        stamps, knocked = count(self.begin_ns, PERIOD_NS), [0.0]

        def passed() -> bool:
            """Knock again and again; a sample may precede the far side's own discovery."""
            if time.monotonic() - knocked[0] > _KNOCK_S:
                knocked[0], stamp_ns = time.monotonic(), next(stamps)
                if wishes:
                    self.wish(stamp_ns, 0.25)
                self.send(ContactSample(stamp_ns, -0.01, 0.0, 0.0))
            # x_r begins at the robot and leaves it, slowly, once a wish has arrived.
            wished = not wishes or len(set(self.reference_positions().values())) > 1
            return wished and bool(self.heard['damping'] and self.heard['diagnostics'])

        self.spin_until(passed, 'the first answer')
        # None is under way any more when the test begins.
        self.answered(next(stamps) - PERIOD_NS)

    def start_afresh(self) -> None:
        """Bring a shared node into the state of a new one, by services and an earlier clock."""
        self.restore_parameters()
        assert self.trigger('reset').success
        for kept in self.heard.values():
            kept.clear()
        self.begin_ns -= 1_000_000_000_000

    # -- samples ------------------------------------------------------------------------------

    def send(self, sample: ContactSample) -> None:
        """Publish one sample on both topics."""
        self.joints.publish(joint_state(sample.stamp_ns, sample.position, sample.velocity))
        self.wrenches.publish(wrench(sample.stamp_ns, sample.force))

    def feed(self, samples: Sequence[ContactSample]) -> None:
        """Publish samples and take what comes for each, a window at a time."""
        for first in range(0, len(samples), WINDOW):
            window = samples[first:first + WINDOW]
            for sample in window:
                self.send(sample)
            self.answered(window[-1].stamp_ns)

    def answered(self, stamp_ns: int) -> None:
        """Wait until a sample has been processed."""
        last = self.heard[ESTIMATES[-1]]
        self.spin_until(lambda: stamp_ns in last, f'the estimate of {stamp_ns}')
        self.spin_until(
            lambda: stamp_ns in self.heard['stiffness']
            and stamp_ns + PERIOD_NS in self.references,
            f'all answers to {stamp_ns}')

    def wish(self, stamp_ns: int, *numbers: float) -> None:
        """Publish a wish that holds from an instant on; see `trajectory`."""
        self.wishes.publish(trajectory(stamp_ns, *numbers))

    @property
    def references(self) -> dict[int, Any]:
        """Return the reference trajectories by their stamps."""
        return self.heard['reference']

    def reference_positions(self) -> dict[int, float]:
        """Positions of the reference by their stamps."""
        return {stamp: m.points[0].positions[0] for stamp, m in self.references.items()}

    def values(self, name: str) -> dict[int, float]:
        """Return published values on the contact axis by their stamps."""
        return {stamp: message.vector.x for stamp, message in self.heard[name].items()}

    def statuses(self) -> list[str]:
        """Texts of the status in the order in which they came."""
        return [message.data for message in self.heard['status'].values()]

    # -- services -----------------------------------------------------------------------------

    def trigger(self, name: str) -> Any:
        """Call ~/reset or ~/tare."""
        return self.call(Trigger, f'{self.name}/{name}', Trigger.Request())

    def names(self) -> list[str]:
        """List the parameters of the node."""
        answer = self.call(
            ListParameters, f'{self.name}/list_parameters', ListParameters.Request())
        return list(answer.result.names)

    def describe(self, names: Sequence[str]) -> list[Any]:
        """Read descriptors."""
        request = DescribeParameters.Request(names=list(names))
        answer = self.call(DescribeParameters, f'{self.name}/describe_parameters', request)
        return list(answer.descriptors)

    def get(self, names: Sequence[str]) -> dict[str, Any]:
        """Read parameters."""
        request = GetParameters.Request(names=list(names))
        answer = self.call(GetParameters, f'{self.name}/get_parameters', request)
        return {
            name: rclpy.parameter.parameter_value_to_python(value)
            for name, value in zip(names, answer.values)
        }

    def _remember(self, names: Iterable[str]) -> None:
        """Keep what parameters are before their first change."""
        new = [name for name in names if name not in self._defaults]
        if new:
            self._defaults.update(self.get(new))
        self._changed.update(names)

    def set(self, values: Mapping[str, Any]) -> list[SetParametersResult]:  # noqa: A003
        """Set parameters, each by itself."""
        self._remember(values)
        request = _set_request(values)
        return list(self.call(SetParameters, f'{self.name}/set_parameters', request).results)

    def set_together(self, values: Mapping[str, Any]) -> SetParametersResult:
        """Set parameters, all or none."""
        request = SetParametersAtomically.Request(parameters=_set_request(values).parameters)
        self._remember(values)
        service = f'{self.name}/set_parameters_atomically'
        return self.call(SetParametersAtomically, service, request).result

    def restore_parameters(self) -> None:
        """Set back what was changed."""
        if self._changed:
            self.set({name: self._defaults[name] for name in self._changed})
            self._changed.clear()

    def change(self, **values: Any) -> None:
        """Set parameters, which must succeed; double underscores stand for dots."""
        results = self.set({name.replace('__', '.'): value for name, value in values.items()})
        assert all(result.successful for result in results), results

    # -- diagnostics --------------------------------------------------------------------------

    def diagnosed(
        self, condition: Callable[[Any, dict[str, str]], Any], what: str, fresh: bool = True
    ) -> None:
        """Wait for a diagnostic status (and its values) of which a condition holds."""
        kept = self.heard['diagnostics']
        if fresh:
            kept.clear()

        def holds() -> bool:
            statuses = [status for message in kept.values() for status in message.status]
            kept.clear()
            return any(condition(s, {v.key: v.value for v in s.values}) for s in statuses)

        self.spin_until(holds, f'diagnostics: {what}')

    def figures(self) -> dict[str, str]:
        """Read the values of a report that is made from now on."""
        found: list[dict[str, str]] = []

        def second(status: Any, values: dict[str, str]) -> bool:
            """Pass over the first: it may have been made before the last sample."""
            found.append(values)
            return len(found) > 1

        self.diagnosed(second, 'two reports')
        return found[-1]

    def rejections(self) -> dict[str, int]:
        """Read the counts of rejected samples by reason."""
        start = 'rejected_'
        figures = self.figures().items()
        return {k.removeprefix(start): int(v) for k, v in figures if k.startswith(start)}

    def counted(self, reason: str, count: int) -> None:
        """Wait until so many rejected samples are counted under a reason."""
        key = f'rejected_{reason}'
        self.diagnosed(lambda _, values: values.get(key) == str(count), f'{count} {reason}')


class ArmDrivers(Listener):
    """Drivers of an arm, and what listens to the estimator node on it."""

    def __init__(self) -> None:
        super().__init__()
        self.wrenches = self.node.create_publisher(WrenchStamped, 'wrench', 100)
        for name in ESTIMATES:
            self.listen(name, Vector3Stamped, f'estimator_node/{name}')
        self.listen('events', String, 'estimator_node/events', EVENTS_QOS)

    def kinds(self) -> list[str]:
        """Return the events heard so far."""
        events = self.heard['events'].values()
        return [EstimationEvent.from_text(event.data).kind for event in events]

    def send(self, instant: Any, stamp_ns: int) -> None:
        """Publish one instant."""
        raise NotImplementedError

    def feed(self, begin_ns: int) -> int:
        """Publish all instants, a window at a time; return the last stamp, once answered."""
        truth = instants()
        for first in range(0, len(truth), WINDOW):
            for instant in truth[first:first + WINDOW]:
                self.send(instant, begin_ns + instant.contact.stamp_ns)
            last_ns = begin_ns + instant.contact.stamp_ns
            self.spin_until(lambda: last_ns in self.heard['damping'], f'the answer to {last_ns}')
        return last_ns

    def assert_replayed(self, bag: Path) -> None:
        """Check that replay of a recording returns the damping that was published."""
        again = bag.with_name('again.mcap')
        assert replay.main([str(bag), '--output', str(again)]) == 0
        decode = Vector3StampedDecoder().decode
        listed = RecordingReader(again).messages(['/estimator_node/damping'])
        values = {stamp: x for stamp, x, _, _ in (decode(message.data) for message in listed)}
        published = {stamp: m.vector.x for stamp, m in self.heard['damping'].items()}
        first = min(published)  # the node may know a publisher before this peer hears the node
        assert {stamp: x for stamp, x in values.items() if stamp >= first} == published


def estimator_and_peer(folder: Path, wishes: bool = True, **parameters: Any) -> Iterator[Peer]:
    """Run an estimator node as long as a fixture lives; yields the peer that has met it."""
    with node_process(folder, 'estimator_node', **parameters):
        peer = Peer()
        try:
            peer.meet(wishes)
            yield peer
        finally:
            peer.close()
