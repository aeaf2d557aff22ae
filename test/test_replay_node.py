# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Replay gives what the node has published, to the bit, whatever was done to the node."""

from itertools import count
from pathlib import Path
import signal
from typing import Callable, NamedTuple

from contact_estimation.exceptions import RecordingError
from contact_estimation.pipeline.replay import RecordingReplay
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.decoding import Vector3StampedDecoder
from contact_estimation.recordings.source import RecordingSource
from contact_estimation.signals.contact_sample import ContactSample
from contact_estimation.signals.stamp_screen import CONFIRMING
from core_runs import contact_samples
import numpy as np
import pytest
from ros_messages import joint_state, moved, Vector3Stamped, wrench
from ros_peer import estimator_and_peer, Peer, PERIOD_NS
from ros_processes import Executable, node_process, wait_until_recorded

pytestmark = pytest.mark.slow

VALUES = ('stiffness', 'damping', 'stiffness_std', 'damping_std')
WANTED = {'/wrench', '/joint_states',
          *(f'/estimator_node/{v}' for v in (*VALUES, 'wall_law', 'events'))}
CONTACT = contact_samples(1.2, depth=0.012, amplitude=0.004, force_noise=0.5)


def biased(samples: list[ContactSample], begin_ns: int) -> list[ContactSample]:
    """Put free flight before the samples, and a bias of -2 N on all of them."""
    noise = np.random.default_rng(1).normal(0.0, 0.5, 300).tolist()
    free = [ContactSample(k * PERIOD_NS, -0.01, 0.0, e) for k, e in enumerate(noise)]
    later = moved(samples, 300 * PERIOD_NS)
    return [s._replace(force=s.force - 2.0) for s in moved(free + later, begin_ns)]


class Recording:
    """A recorder of what a peer and its estimator say, from `begin_ns` on."""

    def __init__(self, peer: Peer, folder: Path, recorder: Executable) -> None:
        self.recorder, self._peer, self._folder = recorder, peer, folder
        for name in VALUES[2:]:
            peer.listen(name, Vector3Stamped, f'{peer.name}/{name}')
        stamps = count(peer.begin_ns + 10**9, PERIOD_NS)

        def complete() -> bool:
            """Send some more samples, enough to be believed after a silence, and look."""
            peer.feed([ContactSample(next(stamps), -0.01, 0.0, 0.0) for _ in range(CONFIRMING)])
            return all(peer.heard[name] for name in VALUES) and self._topics() >= WANTED

        peer.spin_until(complete, 'every topic in the recording')
        assert peer.trigger('reset').success
        self.begin_ns = next(stamps) + 10**9

    def _topics(self) -> set[str]:
        try:
            return set(RecordingReader(self._folder).topics())
        except RecordingError:  # nothing there yet
            return set()

    def _recorded(self, name: str) -> dict[int, float]:
        decode, topic = Vector3StampedDecoder().decode, f'/{self._peer.name}/{name}'
        messages = RecordingReader(self._folder).messages([topic])
        return dict(decode(message.data)[:2] for message in messages)

    def finish(self, last_ns: int) -> 'Compared':
        """End the recorder when the last sample is in, and replay what was recorded."""
        outputs = [f'/{self._peer.name}/{name}' for name in VALUES]
        wait_until_recorded(self._folder, ['/wrench', '/joint_states', *outputs], last_ns)
        self.recorder.signal(signal.SIGINT)
        assert self.recorder.end().code == 0
        replay = RecordingReplay(RecordingReader(self._folder), RecordingSource(), {})
        estimates = [estimate for batch in replay.estimates() for estimate, in batch]
        replayed = {name: {e.stamp_ns: getattr(e, name) for e in estimates} for name in VALUES}
        return Compared({name: self._recorded(name) for name in VALUES}, replayed,
                        dict(replay.session.rejected))


class Compared(NamedTuple):
    """Recorded and replayed values by name and stamp; messages that the replay rejected."""

    recorded: dict[str, dict[int, float]]
    replayed: dict[str, dict[int, float]]
    rejected: dict[str, int]

    def assert_same(self, samples: list[ContactSample]) -> None:
        """Compare all values of samples to the bit."""
        for name in VALUES:
            recorded, replayed = self.recorded[name], self.replayed[name]
            pairs = [(recorded.get(s.stamp_ns), replayed.get(s.stamp_ns)) for s in samples]
            wrong = [(k, *pair) for k, pair in enumerate(pairs) if repr(pair[0]) != repr(pair[1])]
            assert wrong[:1] == [], (
                f'{name} of {len(wrong)} samples: number, recorded, replayed; rejected by the '
                f'replay, which has {len(replayed)}: {self.rejected}')


def changes_reset_and_tare(peer: Peer, begin_ns: int) -> list[ContactSample]:
    samples = biased(CONTACT, begin_ns)
    peer.feed(samples[:290])
    assert peer.trigger('tare').success
    peer.feed(samples[290:590])
    peer.change(conditioning__cutoff_frequency=30.0)
    peer.feed(samples[590:650])
    peer.change(tuning__indirect_adaptive__stiffness_gain=2e4)
    peer.feed(samples[650:700])
    peer.change(estimator='rls')
    peer.feed(samples[700:800])
    assert peer.trigger('reset').success
    peer.feed(samples[800:900])
    peer.change(estimator='kalman', contact__force_noise=0.7)
    peer.feed(samples[900:])
    return samples


def mrac(peer: Peer, begin_ns: int) -> list[ContactSample]:
    samples = moved(CONTACT, begin_ns)
    peer.change(estimator='mrac')
    peer.wish(samples[0].stamp_ns, 0.01, 30.0)
    peer.feed(samples[:600])
    peer.change(tuning__mrac__stiffness_gain=2e4)
    peer.feed(samples[600:])
    return samples


def time_set_back(peer: Peer, begin_ns: int) -> list[ContactSample]:
    samples = moved(CONTACT, begin_ns)
    peer.feed(samples)
    again = moved(CONTACT[:-20], begin_ns - PERIOD_NS // 2)
    peer.feed(again[:500])
    peer.change(estimator='rls')
    peer.feed(again[500:])
    return samples + again


def rejected_messages(peer: Peer, begin_ns: int) -> list[ContactSample]:
    samples = moved(CONTACT, begin_ns)
    peer.feed(samples[:500])
    last = samples[499].stamp_ns
    peer.wrenches.publish(wrench(last + 1_000_000, float('nan')))
    peer.wrenches.publish(wrench(last - PERIOD_NS, -99.0))
    peer.joints.publish(joint_state(last, 9.0, 9.0))
    peer.feed(samples[500:])
    return samples


HAPPENINGS: dict[str, Callable[[Peer, int], list[ContactSample]]] = {
    happening.__name__: happening for happening in (
        changes_reset_and_tare, mrac, time_set_back, rejected_messages)
}
"""What is done to the node, one after the other in one recording."""


@pytest.fixture(scope='module')
def whole(
    tmp_path_factory: pytest.TempPathFactory
) -> tuple[Compared, dict[str, list[ContactSample]]]:
    """Let everything happen, and replay it."""
    place, samples = tmp_path_factory.mktemp('whole'), dict[str, list[ContactSample]]()
    for peer in estimator_and_peer(place / 'estimator', diagnostics_rate=10.0):
        folder = place / 'recording'
        with node_process(place / 'recorder', 'recorder_node', output=folder) as recorder:
            recording = Recording(peer, folder, recorder)
            peer.begin_ns = recording.begin_ns
            for name, happen in HAPPENINGS.items():
                samples[name] = happen(peer, peer.begin_ns)
                peer.restore_parameters()
                assert peer.trigger('reset').success
                peer.begin_ns = max(sample.stamp_ns for sample in samples[name]) + 10**9
            compared = recording.finish(samples[name][-1].stamp_ns)
    return compared, samples  # the node has ended


@pytest.mark.parametrize('name', HAPPENINGS)
def test_replay_equals_the_node_whatever_happened(
    whole: tuple[Compared, dict[str, list[ContactSample]]], name: str
) -> None:
    compared, samples = whole
    compared.assert_same(samples[name])


def test_replay_of_a_recording_begun_after_a_tare_equals_the_node(tmp_path: Path) -> None:
    for peer in estimator_and_peer(tmp_path / 'estimator', diagnostics_rate=10.0):
        begin_ns = peer.begin_ns + 10**9
        peer.feed([ContactSample(begin_ns + k * PERIOD_NS, -0.01, 0.0, -2.0) for k in range(300)])
        assert peer.trigger('tare').success
        peer.begin_ns, folder = begin_ns + 10**9, tmp_path / 'recording'
        with node_process(tmp_path / 'recorder', 'recorder_node', output=folder) as recorder:
            recording = Recording(peer, folder, recorder)
            samples = moved(CONTACT, recording.begin_ns)
            peer.feed([sample._replace(force=sample.force - 2.0) for sample in samples])
            recording.finish(samples[-1].stamp_ns).assert_same(samples)
