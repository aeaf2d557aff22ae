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

"""Replay gives what the node has published, to the bit, whatever was done to the node."""

from __future__ import annotations

from itertools import count
from pathlib import Path
import signal
from typing import Iterator

from contact_estimation.estimation.replay import RecordingReplay
from contact_estimation.exceptions import RecordingError
from contact_estimation.messages import Vector3StampedDecoder
from contact_estimation.recordings import RecordingReader
from contact_estimation.recordings.source import RecordingSource
from contact_estimation.signals.contact_sample import ContactSample
from contact_estimation.signals.stamp_screen import CONFIRMING
from core_runs import contact_samples
import numpy as np
import pytest
from ros_messages import joint_state, moved, Vector3Stamped, wrench
from ros_peer import estimator_and_peer, Peer, PERIOD_NS
from ros_processes import ModuleProcess, node_process, wait_until_recorded

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
    """
    An estimator of its own, its peer, and a recorder; compares the recording with its replay.

    Attributes
    ----------
    recorder : ModuleProcess
        Runs the recorder.
    begin_ns : int
        After the stamps with which the nodes have got to know each other [ns].
    rejected : dict
        Number of messages that the last replay rejected, by reason.

    """

    def __init__(self, peer: Peer, folder: Path, recorder: ModuleProcess) -> None:
        self.peer, self.recorder, self._folder = peer, recorder, folder
        self.rejected: dict[str, int] = {}
        for name in VALUES[2:]:
            peer.listen(name, Vector3Stamped, f'{peer.name}/{name}')
        stamps = count(peer.begin_ns + 10**9, PERIOD_NS)

        def complete() -> bool:
            """Send some more samples, enough to be believed after a silence, and look."""
            peer.feed([
                ContactSample(next(stamps), -0.01, 0.0, 0.0) for _ in range(CONFIRMING)])
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
        decode, topic = Vector3StampedDecoder().decode, f'/{self.peer.name}/{name}'
        messages = RecordingReader(self._folder).messages([topic])
        return dict(decode(message.data)[:2] for message in messages)

    def finish(self, last_ns: int) -> dict[str, dict[int, float]]:
        """End the recorder when the last sample is in; return what was recorded."""
        outputs = [f'/{self.peer.name}/{name}' for name in VALUES]
        wait_until_recorded(self._folder, ['/wrench', '/joint_states', *outputs], last_ns)
        self.recorder.signal(signal.SIGINT)
        assert self.recorder.end().code == 0
        return {name: self._recorded(name) for name in VALUES}

    def replayed(self) -> dict[str, dict[int, float]]:
        """Replay the recording."""
        replay = RecordingReplay(RecordingReader(self._folder), RecordingSource(), {})
        estimates = [estimate for batch in replay.estimates() for estimate, in batch]
        self.rejected = dict(replay.session.rejected)
        return {name: {e.stamp_ns: getattr(e, name) for e in estimates} for name in VALUES}


@pytest.fixture
def recording(tmp_path: Path) -> Iterator[Recording]:
    folder = tmp_path / 'recording'
    with node_process(tmp_path / 'recorder', 'recorder_node', output=folder) as recorder:
        for peer in estimator_and_peer(tmp_path / 'estimator', diagnostics_rate=10.0):
            yield Recording(peer, folder, recorder)


def assert_same(recording: Recording, samples: list[ContactSample]) -> dict[str, dict[int, float]]:
    """End the recording and compare all values of all samples to the bit; return the recorded."""
    stamps = [sample.stamp_ns for sample in samples]
    recorded = recording.finish(stamps[-1])
    replayed = recording.replayed()
    for name in VALUES:
        pairs = [(recorded[name].get(stamp), replayed[name].get(stamp)) for stamp in stamps]
        wrong = [(k, *pair) for k, pair in enumerate(pairs) if repr(pair[0]) != repr(pair[1])]
        assert wrong[:1] == [], (
            f'{name} of {len(wrong)} samples: number, recorded, replayed; rejected by the replay, '
            f'which has {len(replayed[name])}: {recording.rejected}')
    return recorded


def test_replay_repeats_changes_reset_and_tare(recording: Recording) -> None:
    peer, samples = recording.peer, biased(CONTACT, recording.begin_ns)
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
    recorded = assert_same(recording, samples)
    assert recorded['stiffness'][samples[-1].stamp_ns] == pytest.approx(4800.0, rel=0.05)


def test_replay_repeats_a_change_amid_a_stream(recording: Recording) -> None:
    peer, samples = recording.peer, moved(CONTACT, recording.begin_ns)
    peer.feed(samples[:400])
    done = peer.begin_change(estimator='rls')
    peer.feed(samples[400:500])
    peer.spin_until(done, 'the change')
    peer.feed(samples[500:])
    assert_same(recording, samples)


def test_replay_of_mrac_equals_the_node(recording: Recording) -> None:
    peer, samples = recording.peer, moved(CONTACT, recording.begin_ns)
    peer.change(estimator='mrac')
    peer.wish(samples[0].stamp_ns, 0.01, 30.0)
    peer.feed(samples[:600])
    peer.change(tuning__mrac__stiffness_gain=2e4)
    peer.feed(samples[600:])
    assert_same(recording, samples)


def test_replay_over_a_time_set_back_equals_the_node(recording: Recording) -> None:
    peer, samples = recording.peer, moved(CONTACT, recording.begin_ns)
    peer.feed(samples)
    again = moved(CONTACT[:-20], recording.begin_ns - PERIOD_NS // 2)
    peer.feed(again[:500])
    peer.change(estimator='rls')
    peer.feed(again[500:])
    assert_same(recording, samples + again)


def test_replay_leaves_out_what_the_node_has_rejected(recording: Recording) -> None:
    peer, samples = recording.peer, moved(CONTACT, recording.begin_ns)
    peer.feed(samples[:500])
    last = samples[499].stamp_ns
    peer.wrenches.publish(wrench(last + 1_000_000, float('nan')))
    peer.wrenches.publish(wrench(last - PERIOD_NS, -99.0))
    peer.joints.publish(joint_state(last, 9.0, 9.0))
    peer.feed(samples[500:])
    assert_same(recording, samples)


def test_a_recorder_without_cpu_for_a_while_loses_nothing(recording: Recording) -> None:
    peer, samples = recording.peer, moved(CONTACT, recording.begin_ns)
    peer.feed(samples[:200])
    recording.recorder.signal(signal.SIGSTOP)
    peer.feed(samples[200:700])
    recording.recorder.signal(signal.SIGCONT)
    peer.feed(samples[700:])
    assert_same(recording, samples)


def test_replay_leaves_out_a_wrench_of_another_frame(recording: Recording) -> None:
    peer, samples = recording.peer, moved(CONTACT, recording.begin_ns)
    peer.feed(samples[:500])
    peer.joints.publish(joint_state(samples[500].stamp_ns, samples[500].position, 0.0))
    peer.wrenches.publish(wrench(samples[500].stamp_ns, -99.0, 'elsewhere'))
    peer.feed(samples[501:])
    assert_same(recording, samples)


def test_replay_of_a_recording_begun_after_a_tare_equals_the_node(tmp_path: Path) -> None:
    for peer in estimator_and_peer(tmp_path / 'estimator', diagnostics_rate=10.0):
        begin_ns = peer.begin_ns + 10**9
        peer.feed([ContactSample(begin_ns + k * PERIOD_NS, -0.01, 0.0, -2.0) for k in range(300)])
        assert peer.trigger('tare').success
        peer.begin_ns = begin_ns + 10**9
        folder = tmp_path / 'recording'
        with node_process(tmp_path / 'recorder', 'recorder_node', output=folder) as recorder:
            recording = Recording(peer, folder, recorder)
            samples = moved(CONTACT, recording.begin_ns)
            peer.feed([sample._replace(force=sample.force - 2.0) for sample in samples])
            assert_same(recording, samples)
