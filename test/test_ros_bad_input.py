# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Bad input: the node survives, goes on, and counts what it could not use."""

from math import inf, nan
from typing import Any, Callable, Iterator

from core_runs import contact_samples
import pytest
from ros_messages import (
    DiagnosticStatus,
    JOINT,
    joint_state,
    JointState,
    JointTrajectory,
    moved,
    session_results,
    to_stamp,
    trajectory,
    wrench)
from ros_peer import estimator_and_peer, Peer

pytestmark = pytest.mark.slow

TOUCH = contact_samples(0.3, force_noise=0.1)
LONG = contact_samples(1.0, depth=0.012, amplitude=0.004)
CUT = 300  # in contact
MILLISECOND = 1_000_000

Send = Callable[[Peer, int], Any]


def bad_wrench(shift_ns: int, force: float, frame_id: str = 'tool') -> Send:
    """Send a wrench so long after the last good sample."""
    return lambda peer, last: peer.wrenches.publish(wrench(last + shift_ns, force, frame_id))


def bad_joint(shift_ns: int, position: float, *names: str) -> Send:
    """Send a joint state so long after the last good sample."""
    return lambda peer, last: peer.joints.publish(
        joint_state(last + shift_ns, position, 0.0, names or (JOINT,)))


def empty_joint(*names: str) -> Send:
    """Send a joint state without positions."""
    def send(peer: Peer, last: int) -> None:
        message = JointState(name=list(names))
        message.header.stamp = to_stamp(last + MILLISECOND)
        peer.joints.publish(message)

    return send


BAD = [
    ('wrench_not_finite', bad_wrench(MILLISECOND, nan)),
    ('wrench_duplicate', bad_wrench(0, -99.0)),
    ('wrench_out_of_order', bad_wrench(-5 * MILLISECOND, -99.0)),
    ('wrench_frame_id', bad_wrench(MILLISECOND, -99.0, 'elsewhere')),
    ('joint_not_finite', bad_joint(MILLISECOND, inf)),
    ('joint_out_of_order', bad_joint(-5 * MILLISECOND, 9.0)),
    ('joint_states_joint_unknown', bad_joint(MILLISECOND, 9.0, 'elbow')),
    ('joint_states_joint_unknown', empty_joint()),
    ('joint_states_joint_empty', empty_joint(JOINT)),
    ('desired_trajectory_empty', lambda peer, _: peer.wishes.publish(JointTrajectory())),
    ('desired_not_finite', lambda peer, last: peer.wishes.publish(trajectory(last, nan))),
]


@pytest.fixture(scope='module')
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Peer]:
    yield from estimator_and_peer(
        tmp_path_factory.mktemp('bad_input'), joint=JOINT, diagnostics_rate=10.0)


@pytest.mark.parametrize('reason, send', BAD, ids=[f'{k}-{v[0]}' for k, v in enumerate(BAD)])
def test_bad_message_is_counted_and_changes_nothing(peer: Peer, reason: str, send: Send) -> None:
    before = peer.rejections().get(reason, 0)
    samples = moved(TOUCH, peer.begin_ns)
    peer.feed(samples[:CUT])
    send(peer, samples[CUT - 1].stamp_ns)
    peer.feed(samples[CUT:])
    peer.counted(reason, before + 1)
    expected = [result.estimate.stiffness for result in session_results(samples)]
    assert list(peer.values('stiffness').values()) == expected


def test_silence_makes_the_diagnostics_an_error(peer: Peer) -> None:
    peer.feed(moved(TOUCH, peer.begin_ns)[:5])
    peer.diagnosed(
        lambda status, _: status.level == DiagnosticStatus.ERROR
        and status.message.startswith('no wrench for'),
        'silence')


def test_diagnostics_carry_the_figures_of_the_contract(peer: Peer) -> None:
    peer.feed(moved(LONG, peer.begin_ns))
    figures = peer.figures()
    assert {
        'estimator', 'contact', 'excitation_stiffness_std', 'stiffness_std', 'damping_std',
        'rate_hz', 'missing', 'latency_ms_p50', 'status',
    } <= set(figures)
    assert float(figures['stiffness']) == pytest.approx(4800.0, rel=0.01)
