# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimator node with a managed life cycle."""

from __future__ import annotations

from pathlib import Path
import time
from typing import Any, Iterator

from core_runs import contact_samples
import pytest
from rclpy.duration import Duration
from ros_messages import moved
from ros_peer import Peer
from ros_processes import node_process, PATIENCE_S

lifecycle = pytest.importorskip('lifecycle_msgs.srv')
messages = pytest.importorskip('lifecycle_msgs.msg')

pytestmark = pytest.mark.slow

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
