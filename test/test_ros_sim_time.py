# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Simulated time, and what only a fresh node of its own can show."""

from itertools import count
from pathlib import Path
from typing import Any

from core_runs import contact_samples
import pytest
from ros_listener import Listener
from ros_messages import (
    DiagnosticArray, JOINT, joint_state, moved, stamp_of, to_stamp, Vector3Stamped, wrench,
    WrenchStamped)
from ros_peer import estimator_and_peer, PERIOD_NS
from ros_processes import node_process
from sensor_msgs.msg import JointState

clock_messages = pytest.importorskip('rosgraph_msgs.msg')

STEP_NS, LATE_NS = 100_000_000, 7_000_000


class Simulator(Listener):
    """Publishes a clock that stands still until the node has seen it."""

    def __init__(self) -> None:
        super().__init__()
        publisher = self.node.create_publisher
        self.clock = publisher(clock_messages.Clock, '/clock', 10)
        self.wrenches = publisher(WrenchStamped, 'wrench', 10)
        self.joints = publisher(JointState, 'joint_states', 10)
        self.listen('damping', Vector3Stamped, 'estimator_node/damping')
        self.listen('diagnostics', DiagnosticArray, '/diagnostics')

    def newest(self) -> Any:
        """Return the last report; None before the first."""
        return next(reversed(self.heard['diagnostics'].values()), None)

    def meet(self) -> int:
        """Advance the clock until a report has come, and return the time after it [ns]."""
        times = count(10**12, STEP_NS)

        def reported() -> bool:
            self.clock.publish(clock_messages.Clock(clock=to_stamp(next(times))))
            return self.newest() is not None

        self.spin_until(reported, 'the first report')
        return next(times)

    def advance_to(self, now_ns: int) -> None:
        """Set the clock and wait until the node reports at that time: its timer follows it."""
        def reported() -> bool:
            self.clock.publish(clock_messages.Clock(clock=to_stamp(now_ns)))
            report = self.newest()
            return report is not None and stamp_of(report.header.stamp) == now_ns

        self.spin_until(reported, f'a report at {now_ns}')

    def measure(self, stamp_ns: int) -> None:
        """Publish one sample and wait for the estimate."""
        def answered() -> bool:
            self.joints.publish(joint_state(stamp_ns, 0.0, 0.0))
            self.wrenches.publish(wrench(stamp_ns, 0.0))
            return stamp_ns in self.heard['damping']

        self.spin_until(answered, f'the estimate at {stamp_ns}')


@pytest.mark.slow
def test_latency_is_that_of_the_simulated_clock(tmp_path: Path) -> None:
    with node_process(tmp_path, 'estimator_node', use_sim_time=True, diagnostics_rate=10.0):
        simulator = Simulator()
        try:
            begin_ns = simulator.meet()
            for now_ns in range(begin_ns, begin_ns + 5 * STEP_NS, STEP_NS):
                simulator.advance_to(now_ns)
                simulator.measure(now_ns - LATE_NS)
            simulator.advance_to(now_ns + STEP_NS)
            values = {pair.key: pair.value for pair in simulator.newest().status[0].values}
        finally:
            simulator.close()
    assert {name: values[f'latency_ms_{name}'] for name in ('p50', 'p99', 'max')} == {
        'p50': '7.000', 'p99': '7.000', 'max': '7.000'}


K_E = 4800.0
LONG = contact_samples(1.0, depth=0.012, amplitude=0.004)


@pytest.mark.slow
def test_without_desired_trajectory_the_robot_rests_and_presses_with_force_reference(
    tmp_path: Path,
) -> None:
    for peer in estimator_and_peer(tmp_path, False, force_reference=20.0, joint=JOINT):
        peer.start_afresh()
        samples = moved(LONG, peer.begin_ns)
        peer.feed(samples)
        positions = list(peer.reference_positions().values())
        assert positions[:80] == [-0.01] * 80
        K_hat = peer.values('stiffness')[samples[-1].stamp_ns]
        assert positions[-1] == pytest.approx(20.0 / K_hat, abs=5e-6)  # from the surface found
        last = peer.references[samples[-1].stamp_ns + PERIOD_NS]
        assert (last.joint_names, list(last.points[0].effort)) == ([JOINT], [20.0])
