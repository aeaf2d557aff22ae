# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Publishers, nodes and signals: what a node says of its surroundings and its end."""

from pathlib import Path
import subprocess
import sys
from typing import Iterator

from contact_estimation.pipeline.checks.stream_checks import graph_warnings
from contact_estimation.ros.recorder_node import recorded_topics
import pytest
import rclpy
from ros_listener import DEEP_QOS
from ros_messages import DiagnosticStatus, JointState, WrenchStamped
from ros_peer import estimator_and_peer, Peer
from ros_processes import environment


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
def test_whatever_the_estimator_publishes_is_recorded(peer: Peer) -> None:
    published = {topic for topic, _ in peer.node.get_publisher_names_and_types_by_node(
        'estimator_node', '/')}
    assert '/estimator_node/stability' in published
    follows = {f'/estimator_node/{name}' for name in ('compensated_wrench', 'target_pose')}
    assert published - follows - {'/rosout'} <= {
        f'/{topic.lstrip("/")}' for topic in recorded_topics('estimator_node')}


@pytest.mark.slow
def test_a_second_node_of_the_same_name_is_told(peer: Peer) -> None:
    second = rclpy.create_node('estimator_node', context=peer.node.context)
    peer.diagnosed(lambda status, values: '2 nodes are called /estimator_node' in str(values)
                   and status.level != DiagnosticStatus.OK, 'two nodes')
    second.destroy_node()
    peer.diagnosed(lambda status, values: 'nodes are called' not in str(values), 'one node')


NODE = """
import os, signal, sys
from contact_estimation.ros.running import run_node
from rclpy.node import Node
from std_msgs.msg import String

class Interrupted(Node):
    finished = False

    def __init__(self):
        super().__init__('interrupted')
        self.publisher = self.create_publisher(String, 'word', 1)

    def start(self):
        os.kill(os.getpid(), signal.{name})

    def stop(self):
        self.publisher.publish(String(data='last'))
        print('stopped')

sys.exit(run_node(Interrupted, 'a node', [], []))
"""


@pytest.mark.slow
@pytest.mark.parametrize('name', ['SIGINT', 'SIGTERM'])
def test_interrupted_node_can_publish_until_it_has_stopped(tmp_path: Path, name: str) -> None:
    finished = subprocess.run(
        [sys.executable, '-c', NODE.replace('{name}', name)], env=environment(tmp_path),
        capture_output=True, text=True)
    assert (finished.returncode, finished.stdout, finished.stderr) == (0, 'stopped\n', '')


# Interrupts itself when a module is imported.
INTERRUPTED = """
import os, signal, sys
def hook(event, facts):
    if event == 'import' and facts[0] == sys.argv[1]:
        os.kill(os.getpid(), signal.SIGINT)
from contact_estimation import executables
sys.addaudithook(hook)
raise SystemExit(executables.estimator_node())
"""


@pytest.mark.slow
@pytest.mark.parametrize('module', ['rclpy.node', 'std_srvs.srv', 'numpy'])
def test_interrupt_while_a_node_imports_ends_it_without_a_word(
    tmp_path: Path, module: str
) -> None:
    run = subprocess.run(
        [sys.executable, '-c', INTERRUPTED, module], env=environment(tmp_path),
        capture_output=True, text=True, timeout=120.0)
    assert (run.returncode, run.stdout, run.stderr) == (0, '', '')


@pytest.mark.slow
def test_interrupt_while_a_command_imports_is_one_line(tmp_path: Path) -> None:
    code = INTERRUPTED.replace('estimator_node', 'replay')
    run = subprocess.run(
        [sys.executable, '-c', code, 'numpy'], env=environment(tmp_path), capture_output=True,
        text=True, timeout=120.0)
    assert (run.returncode, run.stdout, run.stderr) == (1, '', 'replay: interrupted\n')
