# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What the estimator node says of itself: log, diagnostics, latched status, quality of service."""

from itertools import count, islice
from pathlib import Path
import signal
from typing import Any, Iterator

from arm_contact import JOINTS, PARAMETERS, swung, urdf
from core_runs import contact_samples
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from ros_messages import (
    DiagnosticStatus, joint_state, JointState, moved, String, to_stamp, wrench, WrenchStamped)
from ros_peer import Peer
from ros_processes import node_process

pytestmark = pytest.mark.slow

FAR = [sample._replace(position=sample.position + 0.05) for sample in contact_samples(1.0)]
SAID = 'mm inside the wall; set environment.location to'
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def peer() -> Iterator[Peer]:
    peer = Peer()
    yield peer
    peer.close()


def test_far_wall_is_a_warning_in_log_and_diagnostics_until_set_location(
    tmp_path: Path, peer: Peer
) -> None:
    with node_process(tmp_path, 'estimator_node', diagnostics_rate=10.0) as node:
        peer.meet()
        peer.feed(moved(FAR, peer.begin_ns + 10**9))
        peer.diagnosed(
            lambda status, _: status.level == DiagnosticStatus.WARN
            and SAID in status.message, 'a far wall')
        assert peer.statuses()[-1] == 'estimating'
        assert peer.trigger('set_location').success
        assert peer.get(['environment.location']) == {'environment.location': FAR[-1].position}
        peer.diagnosed(lambda status, _: 'the surface is' not in status.message, 'no far wall')
        late: list[str] = []
        peer.node.create_subscription(
            String, 'estimator_node/status', lambda message: late.append(message.data), LATCHED)
        peer.spin_until(lambda: late, 'the status for a late subscriber')
        node.signal(signal.SIGINT)
        log = node.end().stderr
    assert '[INFO]' in log and 'force from /wrench, motion from /joint_states' in log
    assert '[WARN]' in log and SAID in log
    assert 'changed environment.location' in log


MISFITS: list[tuple[str, dict[str, Any], Any, Any]] = [
    ("joint 'elbow' is not in the message", {'joint': 'elbow'},
     lambda k: wrench(k, 1.0), lambda k: joint_state(k, 0.0, 0.0)),
    ('s behind the wrench', {},
     lambda k: wrench(k + 3 * 10**9, 1.0), lambda k: joint_state(k, 0.0, 0.0)),
]


@pytest.mark.parametrize('text, parameters, make_wrench, make_joint', MISFITS,
                         ids=[m[0] for m in MISFITS])
def test_headline_says_why_no_sample_can_be_used(
    tmp_path: Path, peer: Peer, text: str, parameters: dict[str, Any], make_wrench: Any,
    make_joint: Any,
) -> None:
    with node_process(tmp_path, 'estimator_node', diagnostics_rate=10.0, **parameters):
        stamps = count(10**15, 2_000_000)

        def told() -> bool:
            for stamp in islice(stamps, 10):
                peer.joints.publish(make_joint(stamp))
                peer.wrenches.publish(make_wrench(stamp))
            return any(text in status.message for message in peer.heard['diagnostics'].values()
                       for status in message.status)

        peer.spin_until(told, f'a headline with {text}')


def test_wrench_in_axes_of_the_base_is_the_headline(tmp_path: Path, peer: Peer) -> None:
    pytest.importorskip('pinocchio')
    (tmp_path / 'arm.urdf').write_text(urdf())
    with node_process(tmp_path, 'estimator_node', diagnostics_rate=10.0, **{
            **PARAMETERS, 'tool.mass': 0.0, 'sample_rate': 200.0,
            'robot_description_file': str(tmp_path / 'arm.urdf')}):
        numbers = count()

        def told() -> bool:
            for k in islice(numbers, 10):
                q, force = swung(k, 1.2, (1.0, -2.0, 3.0), 'base')
                joints, measured = JointState(name=JOINTS, position=q), WrenchStamped()
                measured.header.frame_id = 'sensor'
                joints.header.stamp = measured.header.stamp = to_stamp(10**15 + 5_000_000 * k)
                own = measured.wrench.force
                own.x, own.y, own.z = force.tolist()
                peer.joints.publish(joints)
                peer.wrenches.publish(measured)
            return any('set force_sensor.axes to base' in status.message
                       for message in peer.heard['diagnostics'].values()
                       for status in message.status)

        peer.spin_until(told, 'the headline')
