# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What the running node publishes for what it gets."""

from math import isnan
from typing import Iterator

from contact_estimation.estimators.multiple_model import LAWS
from contact_estimation.signals.contact_sample import ContactSample
from contact_estimation.signals.stamp_screen import CONFIRMING
from core_runs import contact_samples
import pytest
from ros_messages import Float64, moved, session_results
from ros_peer import ESTIMATES, estimator_and_peer, Peer, PERIOD_NS

pytestmark = pytest.mark.slow

K_E, B_E = 4800.0, 200.0
FREE = contact_samples(0.0)[:80]  # before the approach begins
TOUCH = contact_samples(0.5, force_noise=0.1)
LONG = contact_samples(1.0, depth=0.012, amplitude=0.004)


@pytest.fixture(scope='module')
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Peer]:
    yield from estimator_and_peer(tmp_path_factory.mktemp('estimator'))


def test_every_wrench_gets_estimates_with_its_stamp_and_nan_on_other_axes(peer: Peer) -> None:
    samples = moved(TOUCH, peer.begin_ns)
    peer.feed(samples)
    for name in ESTIMATES:
        messages = peer.heard[name]
        assert list(messages) == [sample.stamp_ns for sample in samples]
        assert all(isnan(m.vector.y) and isnan(m.vector.z) for m in messages.values())
        assert {m.header.frame_id for m in messages.values()} == {'tool'}


def test_published_estimates_are_those_of_the_session_bit_for_bit(peer: Peer) -> None:
    samples = moved(TOUCH, peer.begin_ns)
    peer.feed(samples)
    estimates = [result.estimate for result in session_results(samples)]
    assert list(peer.values('stiffness').values()) == [e.stiffness for e in estimates]
    assert list(peer.values('damping').values()) == [e.damping for e in estimates]


def test_status_is_published_on_change_alone(peer: Peer) -> None:
    samples = moved(LONG, peer.begin_ns)
    peer.feed(samples)
    statuses = peer.statuses()
    assert statuses[-1] == 'estimating'
    assert len(statuses) < 20
    assert all(one != next_one for one, next_one in zip(statuses, statuses[1:]))


def test_laws_of_the_wall_are_published_on_change_and_stand_in_the_diagnostics(peer: Peer) -> None:
    peer.feed(moved(LONG, peer.begin_ns))
    told = [message.data.split() for message in peer.heard['wall_law'].values()]
    assert 1 < len(told) < 30
    for words in told:
        assert set(words[::2]) <= set(LAWS)
        probabilities = [float(word) for word in words[1::2]]
        assert probabilities == sorted(probabilities, reverse=True)
        assert sum(probabilities) == pytest.approx(1.0, abs=0.04)  # each is rounded to 0.01
    assert told[-1][0] == 'kelvin_voigt' and float(told[-1][1]) > 0.8
    assert peer.figures()['wall_law'].startswith('kelvin_voigt ')


def test_margin_of_the_present_gains_is_published_and_warned_of(peer: Peer) -> None:
    peer.listen('stability', Float64, 'estimator_node/stability')
    peer.change(**{'stability.kind': 'admittance', 'stability.mass': 5.0,
                   'stability.damping': 100.0, 'stability.delay': 0.08})
    peer.feed(moved(LONG, peer.begin_ns))
    peer.spin_until(lambda: any(m.data < 0.0 for m in peer.heard['stability'].values()),
                    'a negative margin')
    peer.spin_until(lambda: float(peer.figures().get('stability_least_damping', 'nan')) > 100.0,
                    'the least damping')
    peer.spin_until(lambda: any('the admittance may be unstable on this wall' in value
                                for value in peer.figures().values()), 'the warning')


def feed_in_time(peer: Peer, samples: list[ContactSample]) -> None:
    """Feed one after the other: x_r goes on from test to test, and in bursts it moves less."""
    peer.feed(samples[:CONFIRMING])
    for sample in samples[CONFIRMING:]:
        peer.feed([sample])


def test_desired_trajectory_passes_through_in_free_flight(peer: Peer) -> None:
    peer.change(reference__maximum_velocity=1e3, reference__fade_s=1e-3)
    samples = moved(FREE, peer.begin_ns)
    peer.wish(peer.begin_ns, 0.125, 30.0, 0.5, -2.0)
    feed_in_time(peer, samples)
    point = peer.references[samples[20].stamp_ns + PERIOD_NS].points[0]
    numbers = [point.positions, point.velocities, point.accelerations, point.effort]
    assert [list(n) for n in numbers] == [[0.125], [0.5], [-2.0], [0.0]]


@pytest.mark.parametrize('law, K_t', [('eq20', None), ('series', 4000.0)])
def test_force_law_holds_in_contact_with_effort(peer: Peer, law: str, K_t: float | None) -> None:
    peer.change(reference_law=law, reference__robot_stiffness=K_t or 5000.0)
    samples = moved(LONG, peer.begin_ns)
    peer.wish(peer.begin_ns, -0.01, 30.0)
    peer.feed(samples)
    last = samples[-1].stamp_ns
    compliance = 1.0 / peer.values('stiffness')[last] + (1.0 / K_t if K_t else 0.0)
    point = peer.references[last + PERIOD_NS].points[0]
    # x_r begins at the surface found, which is known to some micrometres.
    assert point.positions[0] == pytest.approx(30.0 * compliance, abs=5e-6)
    assert list(point.effort) == [30.0]


def test_tare_in_contact_is_refused_with_a_reason(peer: Peer) -> None:
    peer.feed(moved(TOUCH, peer.begin_ns))
    answer = peer.trigger('tare')
    assert not answer.success
    assert answer.message.startswith('in contact')
