# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Topics that cost time and are seldom wanted are published only while somebody subscribes."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Iterator

from core_runs import contact_samples
import pytest
from ros_processes import Listener, session_results, Vector3Stamped, wait_until

OPTIONAL = ('stiffness_std', 'damping_std', 'location', 'inertia')


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
        outputs.publish(result, with_pose=False)
        return len(published)

    assert count_of_one() == 0
    topic = f'{node.node.get_name()}/{name}'
    subscription = node.node.create_subscription(Vector3Stamped, topic, lambda _: None, 10)
    wait_until(publisher.get_subscription_count, 'the subscriber')
    assert count_of_one() == 1
    node.node.destroy_subscription(subscription)
    wait_until(lambda: publisher.get_subscription_count() == 0, 'its end')
    assert count_of_one() == 0
