# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The node on an arm with revolute joints, over DDS."""

from pathlib import Path
from typing import Any, Iterator

from arm_contact import B_E, instants, JOINTS, K_E, NORMAL, PARAMETERS, pose, urdf
from contact_estimation.pipeline.events import DESCRIPTION
from contact_estimation.ros.topics import DESCRIPTION_QOS
import numpy as np
import pytest
from ros_messages import JointState, PoseStamped, String, to_stamp, WrenchStamped
from ros_peer import ArmDrivers
from ros_processes import node_process

pytest.importorskip('pinocchio')
pytestmark = pytest.mark.slow

NODE = 'estimator_node'


class ArmPeer(ArmDrivers):
    """Drivers, robot_state_publisher and user of the node on an arm."""

    def __init__(self) -> None:
        super().__init__()
        self.joints = self.node.create_publisher(JointState, 'joint_states', 100)
        self.description = self.node.create_publisher(
            String, 'robot_description', DESCRIPTION_QOS)
        self.listen('wrench', WrenchStamped, f'{NODE}/compensated_wrench')
        self.listen('pose', PoseStamped, f'{NODE}/target_pose')

    def meet(self) -> None:
        """Wait until the node hears this peer, and has the description."""
        self.spin_until(
            lambda: self.wrenches.get_subscription_count() > 1
            and self.joints.get_subscription_count() > 1 and 'start' in self.kinds(),
            'node and recorder')
        assert DESCRIPTION not in self.kinds()
        self.description.publish(String(data=urdf()))
        self.spin_until(lambda: DESCRIPTION in self.kinds(), 'the event of the description')
        self.knock(range(10_000))

    def knock(self, numbers: range) -> None:
        """Publish the first instant again and again, until wrench and pose come back."""
        stamps = iter(numbers)

        def passed() -> bool:
            self.send(instants()[0], 1_000_000 + 20_000_000 * next(stamps))
            return bool(self.heard['wrench'] and self.heard['pose'] and self.heard['damping'])

        self.spin_until(passed, 'the first outputs')

    def send(self, instant: Any, stamp_ns: int) -> None:
        """Publish one instant, the joints in an order that is not that of the arm."""
        order = [2, 0, 1]
        joints = JointState(
            name=[JOINTS[k] for k in order], position=instant.q[order].tolist(),
            velocity=instant.q_dot[order].tolist())
        wrench = WrenchStamped()
        wrench.header.frame_id = 'sensor'
        joints.header.stamp = wrench.header.stamp = to_stamp(stamp_ns)
        force, torque = wrench.wrench.force, wrench.wrench.torque
        force.x, force.y, force.z, torque.x, torque.y, torque.z = instant.wrench.tolist()
        self.joints.publish(joints)
        self.wrenches.publish(wrench)

    def feed(self, begin_ns: int) -> int:
        """Publish all instants, and wait for what comes for the last."""
        last_ns = super().feed(begin_ns)
        self.spin_until(lambda: last_ns in self.heard['wrench'], 'the last wrench')
        self.spin_until(lambda: max(self.heard['pose']) > last_ns, 'the last pose')
        return last_ns


@pytest.fixture(scope='module')
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp('arm')


@pytest.fixture(scope='module')
def run(folder: Path) -> Iterator[tuple[ArmPeer, int]]:
    with node_process(folder, NODE, publish_target_pose=True, **PARAMETERS):
        peer = ArmPeer()
        try:
            begin_ns = 10**15
            with node_process(folder / 'r', 'recorder_node', output=str(folder / 'bag')):
                peer.meet()
                peer.feed(begin_ns)
            yield peer, begin_ns
        finally:
            peer.close()


def test_stiffness_and_damping_of_the_wall_are_found(run: tuple[ArmPeer, int]) -> None:
    peer, begin_ns = run
    last_ns = begin_ns + instants()[-1].contact.stamp_ns
    assert peer.heard['stiffness'][last_ns].vector.x == pytest.approx(K_E, rel=0.01)
    assert peer.heard['damping'][last_ns].vector.x == pytest.approx(B_E, rel=0.05)


def test_compensated_wrench_is_that_of_the_contact(run: tuple[ArmPeer, int]) -> None:
    peer, begin_ns = run
    instant = instants()[-1]
    message = peer.heard['wrench'][begin_ns + instant.contact.stamp_ns]
    force, torque = message.wrench.force, message.wrench.torque
    in_base = pose(tuple(instant.q), 'sensor')[:3, :3] @ [force.x, force.y, force.z]
    assert message.header.frame_id == 'sensor'
    assert NORMAL @ in_base == pytest.approx(instant.contact.force, abs=1e-9)
    assert [torque.x, torque.y, torque.z] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


def test_target_is_the_measured_pose_with_the_normal_alone_replaced(
    run: tuple[ArmPeer, int]
) -> None:
    peer, _ = run
    message = peer.heard['pose'][max(peer.heard['pose'])]
    T = pose(tuple(instants()[-1].q))
    position, turn = message.pose.position, message.pose.orientation
    moved = np.array([position.x, position.y, position.z]) - T[:3, 3]
    x, y, z, w = turn.x, turn.y, turn.z, turn.w
    first_column = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]
    assert message.header.frame_id == 'base_link'
    np.testing.assert_allclose(first_column, T[:3, 0], atol=1e-9)
    assert abs(NORMAL @ moved) > 1e-3  # x_r rests where the arm was first, outside of the wall
    np.testing.assert_allclose(moved, NORMAL * (NORMAL @ moved), atol=1e-9)


def test_replay_of_its_recording_returns_what_the_node_published(
    run: tuple[ArmPeer, int], folder: Path
) -> None:
    run[0].assert_replayed(folder / 'bag')
