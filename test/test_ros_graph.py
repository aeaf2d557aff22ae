# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Two publishers of a measurement and two nodes of one name are told, from the graph of ROS."""

from __future__ import annotations

from typing import Iterator

from contact_estimation.pipeline.checks.stream_checks import graph_warnings
import pytest
import rclpy
from ros_listener import DEEP_QOS
from ros_messages import DiagnosticStatus, JointState, WrenchStamped
from ros_peer import estimator_and_peer, Peer


@pytest.fixture(scope='module')
def peer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Peer]:
    yield from estimator_and_peer(tmp_path_factory.mktemp('graph'), diagnostics_rate=10.0)


def test_one_publisher_a_topic_and_other_nodes_are_no_warning() -> None:
    assert graph_warnings({'/wrench': ['/driver'], '/joint_states': []}, '/estimator_node',
                          ['/estimator_node', '/left/estimator_node', '/driver']) == {}


@pytest.mark.slow
@pytest.mark.parametrize('topic, message', [
    ('wrench', WrenchStamped), ('joint_states', JointState)])
def test_a_second_publisher_is_told_while_it_is_there(
    peer: Peer, topic: str, message: type
) -> None:
    second = peer.node.create_publisher(message, topic, DEEP_QOS)
    text = f'2 publishers on the topic /{topic}'
    peer.diagnosed(lambda status, values: any(
        value.startswith(text) for key, value in values.items() if key.startswith('warning_')),
        'two publishers')
    peer.node.destroy_publisher(second)
    peer.diagnosed(lambda status, values: text not in str(values), 'one publisher')


@pytest.mark.slow
def test_a_second_node_of_the_same_name_is_told(peer: Peer) -> None:
    second = rclpy.create_node('estimator_node', context=peer.node.context)
    peer.diagnosed(lambda status, values: '2 nodes are called /estimator_node' in str(values)
                   and status.level != DiagnosticStatus.OK, 'two nodes')
    second.destroy_node()
    peer.diagnosed(lambda status, values: 'nodes are called' not in str(values), 'one node')
