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

"""
Nodes as processes of their own, and a peer that talks to them over DDS.

Importing this module skips a test module where there is no ROS. All is run in a ROS domain of
the test session, so that parallel sessions do not hear each other. Nothing here sleeps for luck:
every wait is for a condition, with a time limit that a busy machine does not reach.

"""

from __future__ import annotations

from contextlib import suppress
from itertools import count
from math import nan
import os
from pathlib import Path
import signal
import subprocess
import sys
import time
from typing import Any, Callable, Iterable, Iterator, Mapping, NamedTuple, Sequence

import contact_estimation
from contact_estimation.estimation.parameters import EstimationParameters
from contact_estimation.estimation.result import Result
from contact_estimation.estimation.session import ContactSession
from contact_estimation.parameters.values import build
from contact_estimation.signals.contact_sample import ContactSample
import pytest

rclpy = pytest.importorskip('rclpy')

from builtin_interfaces.msg import Time  # noqa: E402,I100
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402,F401
from geometry_msgs.msg import Vector3Stamped, WrenchStamped  # noqa: E402
from rcl_interfaces.msg import SetParametersResult  # noqa: E402
from rcl_interfaces.srv import DescribeParameters, GetParameters  # noqa: E402
from rcl_interfaces.srv import ListParameters, SetParameters  # noqa: E402
from rcl_interfaces.srv import SetParametersAtomically  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from rclpy.qos import QoSProfile  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_msgs.msg import Float64, String  # noqa: E402,F401
from std_srvs.srv import Trigger  # noqa: E402
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint  # noqa: E402

# Beyond 101 the ports of a domain lie among those that Linux hands out for other purposes.
DOMAIN = int(os.environ.get('CONTACT_ESTIMATION_TEST_DOMAIN', 1 + os.getpid() % 100))
PERIOD_NS = 2_000_000
PATIENCE_S = 240.0
WINDOW = 30  # samples under way at once: less than any queue holds
FRAME = 'tool'
JOINT = 'contact_x'
ESTIMATES = ('stiffness', 'damping')
RELIABLE = {f'qos_overrides./{topic}.subscription.reliability': 'reliable'
            for topic in ('wrench', 'joint_states', 'desired_trajectory')}
_KNOCK_S = 0.02
_NUMBERS = count()
_QOS = QoSProfile(depth=2000)


def environment(log_folder: Path) -> dict[str, str]:
    """Make the environment of a process that shares this session's ROS domain."""
    source = str(Path(contact_estimation.__file__).resolve().parents[1])
    paths = [source, *filter(None, [os.environ.get('PYTHONPATH')])]
    return {
        **os.environ,
        'PYTHONPATH': os.pathsep.join(paths),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'ROS_DOMAIN_ID': str(DOMAIN),
        'ROS_LOG_DIR': str(log_folder),
        'MPLCONFIGDIR': str(log_folder),
    }


def parameter_arguments(parameters: Mapping[str, Any]) -> list[str]:
    """Write parameters as the command line of a node takes them."""
    words = ['--ros-args']
    for name, value in parameters.items():
        text = str(value).lower() if isinstance(value, bool) else str(value)
        words += ['-p', f'{name}:={text}']
    return words


def wait_until(condition: Callable[[], Any], what: str, every_s: float = 0.02) -> None:
    """Wait for something that happens outside of this process."""
    give_up = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < give_up, f'waited in vain for {what}'
        time.sleep(every_s)


def descendants(pid: int) -> list[int]:
    """Return the processes that a process has started, and theirs."""
    children = Path(f'/proc/{pid}/task/{pid}/children').read_text().split()
    return [p for child in map(int, children) for p in (child, *descendants(child))]


class Finished(NamedTuple):
    """How a process has ended and what it has said."""

    code: int
    stdout: str
    stderr: str


class ModuleProcess:
    """A module of the package, running as `python -m` would run it."""

    def __init__(self, folder: Path, module: str, *arguments: str) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self._out, self._err = folder / 'stdout.txt', folder / 'stderr.txt'
        with open(self._out, 'w') as out, open(self._err, 'w') as err:
            self._process = subprocess.Popen(
                [sys.executable, '-m', f'contact_estimation.{module}', *arguments],
                env=environment(folder), cwd=folder, stdout=out, stderr=err,
            )
        self.pid = self._process.pid

    def __enter__(self) -> 'ModuleProcess':
        return self

    def __exit__(self, *trouble: object) -> None:
        if self.running:
            family = [self.pid, *descendants(self.pid)]
            self._process.send_signal(signal.SIGINT)
            try:
                self._process.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                # A child left behind would answer the tests that follow.
                for pid in family:
                    with suppress(ProcessLookupError):
                        os.kill(pid, signal.SIGKILL)
                self._process.wait()

    @property
    def running(self) -> bool:
        """Whether it has not ended yet."""
        return self._process.poll() is None

    def signal(self, number: int) -> None:
        """Send a signal to this process alone."""
        self._process.send_signal(number)

    def end(self) -> Finished:
        """Wait until it ends by itself."""
        code = self._process.wait(PATIENCE_S)
        return Finished(code, self._out.read_text(), self._err.read_text())


def run_module(folder: Path, module: str, *arguments: str) -> Finished:
    """Run a module of the package to its end."""
    with ModuleProcess(folder, module, *arguments) as process:
        return process.end()


def node_process(folder: Path, node: str, **parameters: Any) -> ModuleProcess:
    """
    Start a node; double underscores stand for the dots of parameter names.

    It subscribes reliably: a busy machine loses samples of best effort, and tests compare all.
    """
    named = {name.replace('__', '.'): value for name, value in parameters.items()}
    named = {**(RELIABLE if node != 'plant_node' else {}), **named}
    return ModuleProcess(folder, f'ros.{node}', *parameter_arguments(named))


def stamp_of(time_message: Any) -> int:
    """Read a stamp [ns]."""
    return int(time_message.sec) * 1_000_000_000 + int(time_message.nanosec)


def to_stamp(stamp_ns: int) -> Any:
    """Write a stamp."""
    sec, nanosec = divmod(stamp_ns, 1_000_000_000)
    return Time(sec=sec, nanosec=nanosec)


def wrench(stamp_ns: int, force: float, frame_id: str = FRAME) -> Any:
    """Make a wrench whose other axes could not be mistaken for the contact."""
    message = WrenchStamped()
    message.header.stamp, message.header.frame_id = to_stamp(stamp_ns), frame_id
    message.wrench.force.x, message.wrench.force.y = force, 7.0
    return message


def joint_state(
    stamp_ns: int, position: float, velocity: float, names: Sequence[str] = (JOINT,)
) -> Any:
    """Make a joint state of one axis."""
    message = JointState(name=list(names), position=[position], velocity=[velocity])
    message.header.stamp = to_stamp(stamp_ns)
    return message


def trajectory(
    stamp_ns: int, position: float, effort: float = nan, velocity: float = 0.0,
    acceleration: float = 0.0,
) -> Any:
    """Make a trajectory of one point; no effort where it is NaN."""
    point = JointTrajectoryPoint(
        positions=[position], velocities=[velocity], accelerations=[acceleration],
        effort=[] if effort != effort else [effort],
    )
    message = JointTrajectory(joint_names=[JOINT], points=[point])
    message.header.stamp = to_stamp(stamp_ns)
    return message


def moved(samples: Iterable[ContactSample], begin_ns: int) -> list[ContactSample]:
    """Shift stamps."""
    return [sample._replace(stamp_ns=sample.stamp_ns + begin_ns) for sample in samples]


def session_results(samples: Iterable[ContactSample], **parameters: Any) -> list[Result]:
    """Pass samples through a fresh session without ROS; double underscores stand for dots."""
    names = {name.replace('__', '.'): value for name, value in parameters.items()}
    session = ContactSession(build(EstimationParameters, names))
    results: list[Result] = []
    for stamp_ns, position, velocity, force in samples:
        results += session.add_motion(stamp_ns, position, velocity)
        results += session.add_wrench(stamp_ns, force)
    return results


def _set_request(values: Mapping[str, Any]) -> Any:
    return SetParameters.Request(parameters=[
        Parameter(name, value=value).to_parameter_msg() for name, value in values.items()
    ])


class Listener:
    """
    A ROS node of the test, spun only while it waits for something.

    Attributes
    ----------
    heard : dict
        For each topic listened to, its messages by their stamps [ns] (by number where the type
        has no header), in the order in which they came.

    """

    def __init__(self) -> None:
        os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=DOMAIN)
        name = f'test_{os.getpid()}_{next(_NUMBERS)}'
        self.node = rclpy.create_node(name, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self.heard: dict[str, dict[int, Any]] = {}
        self._clients: dict[str, Any] = {}

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def listen(self, name: str, message_type: Any, topic: str, qos: Any = _QOS) -> Any:
        """Keep all messages of a topic under a name."""
        kept = self.heard.setdefault(name, {})

        def keep(message: Any) -> None:
            has_header = hasattr(message, 'header') and name != 'diagnostics'
            kept[stamp_of(message.header.stamp) if has_header else len(kept)] = message

        return self.node.create_subscription(message_type, topic, keep, qos)

    def spin_until(self, condition: Callable[[], Any], what: str) -> None:
        """Serve this node until a condition holds."""
        give_up = time.monotonic() + PATIENCE_S
        while not condition():
            assert time.monotonic() < give_up, f'waited in vain for {what}'
            self._executor.spin_once(timeout_sec=0.1)

    def call(self, service_type: Any, name: str, request: Any) -> Any:
        """Call a service and wait for its answer."""
        future = self.begin_call(service_type, name, request)
        self.spin_until(future.done, f'the answer of {name}')
        return future.result()

    def begin_call(self, service_type: Any, name: str, request: Any) -> Any:
        """Call a service without waiting for its answer."""
        if name not in self._clients:
            self._clients[name] = self.node.create_client(service_type, name)
        client = self._clients[name]
        self.spin_until(client.service_is_ready, f'service {name}')
        return client.call_async(request)


class Peer(Listener):
    """
    Sensor, planner and user of one estimator node.

    Parameters
    ----------
    node : str
        Name of the estimator node.

    """

    def __init__(self, node: str = 'estimator_node') -> None:
        super().__init__()
        self.name = node
        publisher = self.node.create_publisher
        self.wrenches = publisher(WrenchStamped, 'wrench', _QOS)
        self.joints = publisher(JointState, 'joint_states', _QOS)
        self.wishes = publisher(JointTrajectory, 'desired_trajectory', _QOS)
        for name in ESTIMATES:
            self.listen(name, Vector3Stamped, f'{node}/{name}')
        self.listen('reference', JointTrajectory, 'reference_trajectory')
        self.listen('status', String, f'{node}/status')
        self.listen('diagnostics', DiagnosticArray, '/diagnostics')
        self.begin_ns = 1_000_000_000_000_000
        self._changed: set[str] = set()
        self._defaults: dict[str, Any] = {}

    # -- finding each other -------------------------------------------------------------------

    def meet(self) -> None:
        """Wait until every message passes, both ways."""
        outputs = [f'{self.name}/{name}' for name in (*ESTIMATES, 'status')]
        inputs = (self.wrenches, self.joints, self.wishes)
        self.spin_until(
            lambda: all(p.get_subscription_count() for p in inputs)
            and all(self.node.count_publishers(topic) for topic in outputs),
            'discovery',
        )
        stamps, knocked = count(self.begin_ns, PERIOD_NS), [0.0]

        def passed() -> bool:
            """Knock again and again; a sample may precede the far side's own discovery."""
            if time.monotonic() - knocked[0] > _KNOCK_S:
                knocked[0], stamp_ns = time.monotonic(), next(stamps)
                self.wish(stamp_ns, 0.25)
                self.send(ContactSample(stamp_ns, -0.01, 0.0, 0.0))
            # x_r begins at the robot and leaves it, slowly, once a wish has arrived.
            wished = len(set(self.reference_positions().values())) > 1
            return wished and bool(self.heard['damping'] and self.heard['diagnostics'])

        self.spin_until(passed, 'the first answer')
        # None is under way any more when the test begins.
        self.answered(next(stamps) - PERIOD_NS)

    def start_afresh(self) -> int:
        """
        Bring a shared node into the state of a new one, as far as its services can.

        Returns
        -------
        begin_ns : int
            Before all stamps so far, which tells the node that time was set back [ns].

        """
        if self._changed:
            self.set({name: self._defaults[name] for name in self._changed})
            self._changed.clear()
        assert self.trigger('reset').success
        for kept in self.heard.values():
            kept.clear()
        self.begin_ns -= 1_000_000_000_000
        return self.begin_ns

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
            f'all answers to {stamp_ns}',
        )

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
            ListParameters, f'{self.name}/list_parameters', ListParameters.Request()
        )
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

    def set(self, values: Mapping[str, Any]) -> list[SetParametersResult]:  # noqa: A003
        """Set parameters, each by itself."""
        new = [name for name in values if name not in self._defaults]
        if new:
            self._defaults.update(self.get(new))
        self._changed.update(values)
        request = _set_request(values)
        return list(self.call(SetParameters, f'{self.name}/set_parameters', request).results)

    def set_together(self, values: Mapping[str, Any]) -> SetParametersResult:
        """Set parameters, all or none."""
        request = SetParametersAtomically.Request(parameters=_set_request(values).parameters)
        self._defaults.update(self.get([name for name in values if name not in self._defaults]))
        self._changed.update(values)
        service = f'{self.name}/set_parameters_atomically'
        return self.call(SetParametersAtomically, service, request).result

    def begin_change(self, **values: Any) -> Callable[[], bool]:
        """Ask for a change of parameters without waiting; tells when it is done."""
        request = _set_request(values)
        future = self.begin_call(SetParameters, f'{self.name}/set_parameters', request)
        return lambda: bool(future.done() and future.result().results[0].successful)

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


def estimator_and_peer(folder: Path, **parameters: Any) -> Iterator[Peer]:
    """Run an estimator node as long as a fixture lives; yields the peer that has met it."""
    with node_process(folder, 'estimator_node', **parameters):
        peer = Peer()
        try:
            peer.meet()
            yield peer
        finally:
            peer.close()
