# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The node on an arm whose poses come from tf, and watched, over DDS."""

from itertools import count
from pathlib import Path
import signal
import subprocess
import sys
from typing import Any

from arm_contact import B_E, instants, K_E, MOVING, OF_TF, static_bytes, transform
from contact_estimation.ros.topics import has_transforms, message_class, TF_STATIC_QOS
import pytest
from reference_messages import TF, transforms_bytes, wrench_bytes
from ros_messages import DiagnosticArray, DiagnosticStatus, joint_state, wrench
from ros_peer import ArmDrivers, Peer
from ros_processes import node_process, wait_until

NODE = 'estimator_node'
needs_tf = pytest.mark.skipif(
    not has_transforms(), reason='tf2_msgs is not installed; it is not on PyPI')


class Robot(ArmDrivers):
    """Drivers and robot_state_publisher, serialised independently of the package under test."""

    def __init__(self) -> None:
        super().__init__()
        publisher, TFMessage = self.node.create_publisher, message_class(TF)
        self.transforms = publisher(TFMessage, '/tf', 100)
        self.static = publisher(TFMessage, '/tf_static', TF_STATIC_QOS)
        self.listen('diagnostics', DiagnosticArray, '/diagnostics')

    def send(self, instant: Any, stamp_ns: int) -> None:
        """Publish one instant."""
        moving = [transform(instant.q, link, stamp_ns) for link in MOVING]
        self.transforms.publish(transforms_bytes(moving))
        self.wrenches.publish(wrench_bytes(
            instant.wrench[:3], instant.wrench[3:], stamp_ns=stamp_ns, frame_id='sensor'))

    def says(self, level: bytes, text: str) -> bool:
        """Return whether the diagnostics have said a text."""
        return any(status.level == level and text in status.message
                   for message in self.heard['diagnostics'].values()
                   for status in message.status)


@pytest.mark.slow
@needs_tf
def test_poses_of_tf_give_stiffness_and_damping_and_replay_repeats_them(tmp_path: Path) -> None:
    begin_ns, stamps = 10**15, iter(range(10**9, 10**12, 20_000_000))
    with node_process(tmp_path, NODE, diagnostics_rate=10.0, **OF_TF):
        robot = Robot()
        try:
            with node_process(tmp_path / 'r', 'recorder_node', output=str(tmp_path / 'bag')):
                robot.spin_until(
                    lambda: robot.wrenches.get_subscription_count() > 1
                    and robot.transforms.get_subscription_count() > 1, 'node and recorder')

                def refused() -> bool:
                    robot.send(instants()[0], next(stamps))
                    return robot.says(
                        DiagnosticStatus.ERROR, "no transform of tf connects 'base_link'")

                robot.spin_until(refused, 'the missing transforms')
                robot.static.publish(static_bytes())

                def passed() -> bool:
                    robot.send(instants()[0], next(stamps))
                    return bool(robot.heard['damping'])

                robot.spin_until(passed, 'the first estimate')
                robot.feed(begin_ns)
        finally:
            robot.close()
    assert robot.kinds() == ['start', 'static_transforms', 'arm_ready']
    last_ns = begin_ns + instants()[-1].contact.stamp_ns
    assert robot.heard['stiffness'][last_ns].vector.x == pytest.approx(K_E, rel=0.01)
    assert robot.heard['damping'][last_ns].vector.x == pytest.approx(B_E, rel=0.1)
    robot.assert_replayed(tmp_path / 'bag')


pytest.importorskip('rerun')


def paths_in(file: Path) -> str:
    """Print what a file of Rerun holds."""
    return subprocess.run([sys.executable, '-m', 'rerun', 'rrd', 'print', '-v', str(file)],
                          capture_output=True, text=True, check=True).stdout


@pytest.mark.slow
def test_watch_node_shows_what_is_published(tmp_path: Path) -> None:
    file = tmp_path / 'view.rrd'
    peer = Peer()
    try:
        with node_process(tmp_path / 'log', 'watch_node', show=str(file)) as node:
            wait_until(file.exists, 'the view')
            before, numbers = file.stat().st_size, count(1)

            def seen() -> bool:
                stamp_ns = peer.begin_ns + 2_000_000 * next(numbers)
                peer.joints.publish(joint_state(stamp_ns, 0.001, 0.0))
                peer.wrenches.publish(wrench(stamp_ns, -5.0))
                return file.stat().st_size > before + 20_000

            wait_until(seen, 'a shown wrench')
            node.signal(signal.SIGINT)
            assert node.end().code == 0
    finally:
        peer.close()
    held = paths_in(file)
    assert '/force/measured' in held and '/motion/measured' in held
