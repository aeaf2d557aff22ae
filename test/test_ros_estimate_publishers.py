# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Topics that cost time and are seldom wanted are published only while somebody subscribes."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any, Iterator

from contact_estimation.estimators.stiffness_matrix import (
    StiffnessMatrix, StiffnessMatrixParameters)
from contact_estimation.pipeline.axes import MATRIX_TOPICS
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples
import pytest
from ros_listener import Listener
from ros_messages import Float64, session_results, Vector3Stamped
from ros_processes import wait_until

OPTIONAL = ('stiffness_std', 'damping_std', 'location', 'inertia', 'model_fit')
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
        TYPES.get(name, Vector3Stamped), topic, lambda _: None, 10
    )
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
