# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The node on an arm without a force sensor, over DDS."""

from pathlib import Path

from contact_estimation.parameters import build
from contact_estimation.pipeline.inputs import MessageInputs
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from effort_worlds import described, messages, parameters
import pytest
from ros_listener import DEEP_QOS, Listener
from ros_messages import DiagnosticArray, JointState, Vector3Stamped
from ros_peer import WINDOW
from ros_processes import node_process

pytest.importorskip('pinocchio')
pytestmark = pytest.mark.slow

NODE = 'estimator_node'


def test_node_estimates_from_joint_states_alone(tmp_path: Path) -> None:
    rows = messages()[:2000]
    session = ContactSession(build(EstimationParameters, parameters()))
    session.describe(described())
    inputs = MessageInputs(session)
    last = [one for _, raw in rows for one in inputs.process_motion(raw)][-1]
    (tmp_path / 'arm.urdf').write_text(described())
    given = parameters(robot_description_file=str(tmp_path / 'arm.urdf'))
    with node_process(tmp_path, NODE, **given):
        peer = Listener()
        try:
            joints = peer.node.create_publisher(JointState, 'joint_states', DEEP_QOS)
            peer.listen('stiffness', Vector3Stamped, f'{NODE}/stiffness')
            peer.spin_until(lambda: joints.get_subscription_count() > 0, 'the node')
            peer.spin_until(lambda: peer.node.count_publishers(f'/{NODE}/stiffness'), 'its topics')
            for first in range(0, len(rows), WINDOW):
                for stamp_ns, raw in rows[first:first + WINDOW]:
                    joints.publish(raw)
                peer.spin_until(lambda: max(peer.heard['stiffness'], default=0) >
                                stamp_ns - 20_000_000, f'the answer to {stamp_ns}')
            heard = peer.heard['stiffness'][last.sample.stamp_ns]
            assert heard.vector.x == last.estimate.stiffness
            assert heard.header.frame_id == 'link_6'
            peer.listen('diagnostics', DiagnosticArray, '/diagnostics')
            peer.spin_until(lambda: any(
                one.message.startswith('no efforts of joints for')
                for told in peer.heard['diagnostics'].values() for one in told.status), 'silence')
        finally:
            peer.close()
