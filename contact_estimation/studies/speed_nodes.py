# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The estimator node against a node that only echoes, on the same topics; run, it is the latter.

The echo uses nothing of this package's data path: rclpy converts the messages, on a standard
executor. It answers every wrench with the last setpoint, so that the plant moves as with an
estimator.
"""

import json
import os
from pathlib import Path
from statistics import median
import subprocess
import sys
from tempfile import TemporaryDirectory
import time
from typing import Any, Sequence

from geometry_msgs.msg import WrenchStamped
import numpy as np
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from ..exceptions import ContactEstimationError
from ..reference.experiment import START
from ..ros import topics
from ..ros.loop_processes import end_process

_RATES = (500.0, 1000.0)
_RUN_S, _ROUNDS = 15.0, 2
_NODES = {'echo': ('contact_estimation.studies.speed_nodes',),
          'estimator': ('contact_estimation', 'estimator_node')}
_SAMPLING_S, _TIMEOUT_S, _END_TIMEOUT_S = 0.05, 60.0, 5.0


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
            JointTrajectory, topics.REFERENCE, topics.OUTPUT_QOS)

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


def compared_nodes(estimator: str) -> list[dict[str, Any]]:
    """Alternate echo and estimator: ratios of the same round, medians over the rounds."""
    table = []
    for rate in _RATES:
        runs = [[_run_once(node, rate, estimator) for node in _NODES] for _ in range(_ROUNDS)]
        row: dict[str, Any] = {'rate [Hz]': rate}
        for name in ('CPU [%]', 'p50 [ms]', 'p99 [ms]'):
            row[name] = median(own[name] for _, own in runs)
            row[f'{name.partition(" ")[0]}/echo'] = median(
                own[name] / max(echo[name], 1e-9) for echo, own in runs)
        for k, node in enumerate(_NODES):
            row[f'dropped, {node}'] = (sum(pair[k]['lost'] for pair in runs)
                                       / sum(pair[k]['sent'] for pair in runs))
        table.append(row)
    return table


def _run_once(node: str, rate: float, estimator: str) -> dict[str, float]:
    """Run the plant with a node; measure CPU load and latency while samples are sent."""
    with TemporaryDirectory() as folder:
        summary = Path(folder) / 'plant.json'
        own = [f'estimator:={estimator}'] if node == 'estimator' else []
        tested = _started(_NODES[node], f'sample_rate:={rate:.1f}', *own)
        plant = _started(('contact_estimation', 'plant_node'), f'sample_rate:={rate:.1f}',
                         f'duration:={_RUN_S:.3f}', 'repeat:=true', 'subscribers:=1',
                         f'summary_file:={summary}')
        try:
            used = _watched(node, tested, plant, time.monotonic() + _RUN_S + _TIMEOUT_S)
        finally:
            end_process(plant, _END_TIMEOUT_S)
            end_process(tested, _END_TIMEOUT_S)
        found = json.loads(summary.read_text())
    if found['latency_ms']['p99'] is None:
        raise ContactEstimationError(
            f'{node} must publish a reference for each sample, but published none for '
            f'{found["samples_sent"]}')
    begin_s = 1e-9 * found['begin_stamp_ns']
    duration_s = found['samples_sent'] / rate
    before, after = np.interp([begin_s, begin_s + duration_s], *np.array(used).T)
    return {'CPU [%]': float(100.0 * (after - before) / duration_s),
            **{f'{name} [ms]': found['latency_ms'][name] for name in ('p50', 'p99')},
            'sent': found['samples_sent'], 'lost': found['samples_lost']}


def _started(module: Sequence[str], *parameters: str) -> subprocess.Popen[bytes]:
    """Start a node in a ROS domain free of other traffic."""
    environment = {**os.environ, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
                   'ROS_DOMAIN_ID': str(1 + os.getpid() % 100)}
    options = [word for parameter in parameters for word in ('-p', parameter)]
    return subprocess.Popen([sys.executable, '-m', *module, '--ros-args', *options],
                            env=environment, start_new_session=True, stdout=subprocess.DEVNULL)


def _watched(
    node: str, tested: subprocess.Popen[bytes], plant: subprocess.Popen[bytes], until: float
) -> list[tuple[float, float]]:
    """Return time and CPU time of the node [s] until the plant has ended."""
    ticks, used = os.sysconf('SC_CLK_TCK'), []
    while plant.poll() is None:
        if tested.poll() is not None or time.monotonic() > until:
            raise ContactEstimationError(
                f'{node} or plant_node did not run to the end: {tested.returncode}')
        fields = Path(f'/proc/{tested.pid}/stat').read_text().rpartition(')')[2].split()
        used.append((time.time(), (int(fields[11]) + int(fields[12])) / ticks))
        time.sleep(_SAMPLING_S)
    if plant.returncode:
        raise ContactEstimationError(f'plant_node ended with {plant.returncode}')
    return used


def main() -> int:
    """Run the echo until it is interrupted."""
    rclpy.init()
    try:
        rclpy.spin(EchoNode())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == '__main__':
    raise SystemExit(main())
