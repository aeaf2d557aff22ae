# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The managed node, and topics published only while somebody subscribes."""

from functools import partial
from pathlib import Path
import time
from typing import Any, Iterator

from contact_estimation.estimators.stiffness_matrix import (
    StiffnessMatrix, StiffnessMatrixParameters)
from contact_estimation.pipeline.axes import MATRIX_TOPICS
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples
import pytest
from rclpy.duration import Duration
from ros_listener import Listener
from ros_messages import Float64, moved, session_results, Vector3Stamped
from ros_peer import Peer
from ros_processes import node_process, PATIENCE_S, wait_until

lifecycle = pytest.importorskip('lifecycle_msgs.srv')
messages = pytest.importorskip('lifecycle_msgs.msg')

SAMPLES = contact_samples(1.0)
PATIENCE = Duration(seconds=PATIENCE_S)
Transition = messages.Transition
ASK_AGAIN_S = 1.0


@pytest.fixture
def peer() -> Iterator[Peer]:
    peer = Peer()
    yield peer
    peer.close()


def change(peer: Peer, transition: int) -> bool:
    request = lifecycle.ChangeState.Request()
    request.transition.id = transition
    answer = peer.call(lifecycle.ChangeState, 'estimator_node/change_state', request)
    return bool(answer.success)


def meet_service(peer: Peer) -> None:
    """Ask for no known transition until the service answers: it may not see this client yet."""
    request = lifecycle.ChangeState.Request()
    request.transition.id = Transition.TRANSITION_CREATE
    asked: list[Any] = []

    def answered() -> bool:
        if not asked or time.monotonic() - asked[-1][0] > ASK_AGAIN_S:
            begun = peer.begin_call(lifecycle.ChangeState, 'estimator_node/change_state', request)
            asked.append((time.monotonic(), begun))
        return any(begun.done() for _, begun in asked)

    peer.spin_until(answered, 'the first answer of the service')


@pytest.mark.slow
def test_managed_node_estimates_only_while_it_is_active(tmp_path: Path, peer: Peer) -> None:
    with node_process(tmp_path, 'managed_estimator_node') as node:
        meet_service(peer)
        assert change(peer, Transition.TRANSITION_CONFIGURE)
        assert change(peer, Transition.TRANSITION_ACTIVATE)
        peer.meet()
        fed = moved(SAMPLES, peer.begin_ns + 10**9)
        peer.feed(fed[:300])
        assert change(peer, Transition.TRANSITION_DEACTIVATE)
        for sample in fed[300:310]:
            peer.send(sample)
        for publisher in (peer.wrenches, peer.joints):
            assert publisher.wait_for_all_acked(PATIENCE)
        assert change(peer, Transition.TRANSITION_ACTIVATE)
        peer.feed(fed[310:])
        estimated = peer.heard['stiffness']
        assert {one.stamp_ns for one in fed} - set(estimated) == {
            one.stamp_ns for one in fed[300:310]}
        assert change(peer, Transition.TRANSITION_DEACTIVATE)
        assert not change(peer, Transition.TRANSITION_DEACTIVATE)
        assert change(peer, Transition.TRANSITION_CLEANUP)
        assert change(peer, Transition.TRANSITION_UNCONFIGURED_SHUTDOWN)
        assert node.end().code == 0


OPTIONAL = ('location', 'model_fit')
TYPES = {'model_fit': Float64}


@pytest.fixture
def node(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Listener]:
    monkeypatch.setenv('ROS_LOG_DIR', str(tmp_path))
    listener = Listener()
    yield listener
    listener.close()


@pytest.mark.parametrize('name', OPTIONAL)
def test_optional_topic_is_published_while_somebody_subscribes(
    node: Listener, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    from contact_estimation.ros.estimate_publishers import EstimatePublishers

    published: list[bytes] = []
    outputs = EstimatePublishers(node.node, '')
    outputs.use('tool', 'x')
    publisher = outputs._publishers[name]
    monkeypatch.setattr(publisher, 'publish', published.append)
    result: Any = session_results(contact_samples(0.0)[:1])[0]

    def count_of_one() -> int:
        """Publish one result; count what went out on the topic."""
        published.clear()
        outputs.look_for_subscribers()
        outputs.publish(result)
        return len(published)

    assert count_of_one() == 0
    topic = f'{node.node.get_name()}/{name}'
    subscription = node.node.create_subscription(
        TYPES.get(name, Vector3Stamped), topic, lambda _: None, 10)
    wait_until(publisher.get_subscription_count, 'the subscriber')
    assert count_of_one() == 1
    node.node.destroy_subscription(subscription)
    wait_until(lambda: publisher.get_subscription_count() == 0, 'its end')
    assert count_of_one() == 0


def test_matrices_are_published_with_labels(
    node: Listener, monkeypatch: pytest.MonkeyPatch
) -> None:
    from contact_estimation.ros.estimate_publishers import EstimatePublishers
    from rclpy.serialization import deserialize_message
    from std_msgs.msg import Float64MultiArray, String

    outputs = EstimatePublishers(node.node, '')
    outputs.use('tool', 'xyz')
    estimator = StiffnessMatrix(StiffnessMatrixParameters(), 0.001)
    rest = [tuple(ContactSample(2_000_000 * k, 0.0, 0.0, -f) for f in (3.0, 2.0, 1.0))
            for k in range(150)]
    published: dict[str, bytes] = {}
    for name, publisher in outputs._matrices.items():
        monkeypatch.setattr(publisher, 'publish', partial(published.__setitem__, name))
    outputs.publish_matrices(estimator.process(rest, [True] * 150)[-1])
    assert set(published) == set(MATRIX_TOPICS)
    status = deserialize_message(published['matrix_status'], String)
    assert status.data == 'frozen: no motion'
    array = deserialize_message(published['stiffness_matrix'], Float64MultiArray)
    labels = [(d.label, d.size, d.stride) for d in array.layout.dim]
    assert labels[0] == ('stiffness/stiffness_std/damping/damping_std', 4, 36)
    assert [size for _, size, _ in labels] == [4, 3, 3] and len(array.data) == 36
