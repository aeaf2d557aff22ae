# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A topic that a starved recorder received late is replayed as if it had come in time."""

from __future__ import annotations

from itertools import chain
from math import nan
from pathlib import Path
from typing import Iterable, Sequence

from contact_estimation.estimation.inputs import MessageInputs
from contact_estimation.estimation.parameters import EstimationParameters
from contact_estimation.estimation.replay import RecordingReplay
from contact_estimation.estimation.session import ContactSession
from contact_estimation.messages import JointStateEncoder, WrenchEncoder
from contact_estimation.recordings import RecordingReader, RecordingWriter
from contact_estimation.recordings.source import RecordingSource
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples
import pytest

TYPES = {'/wrench': 'geometry_msgs/msg/WrenchStamped',
         '/joint_states': 'sensor_msgs/msg/JointState'}
BEGIN_NS, PERIOD_NS = 1_750_000_000_000_000_000, 2_000_000
SAMPLES = [sample._replace(stamp_ns=BEGIN_NS + sample.stamp_ns)
           for sample in contact_samples(3.0, force_noise=0.5)]
CHUNK = 200  # messages
Sent = tuple[int, str, bytes]
Replayed = dict[str, tuple[list[str], dict[str, int]]]


def sent(samples: Sequence[ContactSample]) -> list[Sent]:
    """Encode samples: number of the sample, topic and message."""
    wrenches, joints = WrenchEncoder('tool'), JointStateEncoder('tool', 'contact_x', True)
    return list(chain.from_iterable(
        [(k, '/joint_states', joints.encode(stamp_ns, x, v)),
         (k, '/wrench', wrenches.encode(stamp_ns, force, 0.0, 0.0))]
        for k, (stamp_ns, x, v, force) in enumerate(samples)))


def late(messages: Iterable[Sent], topic: str, first: int, until: int) -> list[Sent]:
    """Let a topic from one sample on not be received before another."""
    def received(message: Sent) -> int:
        number = message[0]
        return max(until, number) if message[1] == topic and number >= first else number

    return sorted(messages, key=received)


def replayed(path: Path, messages: Iterable[Sent]) -> tuple[list[str], dict[str, int]]:
    """Record messages in this order and replay them; return estimates and rejections."""
    with RecordingWriter.file(path) as writer:
        for k, (_, topic, raw) in enumerate(messages):
            writer.write(topic, TYPES[topic], raw, BEGIN_NS + k * PERIOD_NS // 2)
            if k % CHUNK == CHUNK - 1:
                writer.flush()
    replay = RecordingReplay(RecordingReader(path), RecordingSource(), {})
    estimates = [repr(axes) for batch in replay.estimates() for axes in batch]
    return estimates, dict(replay.session.rejected)


IN_TIME = sent(SAMPLES)
BAD = sent([sample._replace(force=nan) if k % 400 == 300 else sample
            for k, sample in enumerate(SAMPLES)])
BACK = sent([*SAMPLES, *(sample._replace(stamp_ns=sample.stamp_ns - PERIOD_NS // 2)
                         for sample in SAMPLES)])

LIES = (lambda ns: 0, lambda ns: ns + 6 * 10**8, lambda ns: ns - 3 * 10**9)
FALSE = sent([sample._replace(stamp_ns=LIES[k % 3](sample.stamp_ns)) if k % 100 == 50 else sample
              for k, sample in enumerate(SAMPLES)])


KINDS = {'regular': IN_TIME, 'with NaN': BAD, 'set back': BACK, 'false stamps': FALSE}


@pytest.fixture(scope='module')
def in_time(tmp_path_factory: pytest.TempPathFactory) -> Replayed:
    """Replay each kind of recording without a late topic."""
    folder = tmp_path_factory.mktemp('in_time')
    return {kind: replayed(folder / f'{kind}.mcap', messages) for kind, messages in KINDS.items()}


@pytest.mark.parametrize('topic', TYPES)
@pytest.mark.parametrize('kind', KINDS)
@pytest.mark.parametrize('span', ((0, 110), (120, 710), (310, 380), (1000, 1470)))
def test_replay_is_that_of_the_topic_in_time(
    in_time: Replayed, tmp_path: Path, topic: str, kind: str, span: tuple[int, int]
) -> None:
    delayed = late(KINDS[kind], topic, *span)
    assert delayed != KINDS[kind]
    assert replayed(tmp_path / 'a.mcap', delayed) == in_time[kind]
    assert len(in_time[kind][0]) > 1700 and not in_time[kind][1].get('joint_missing')


@pytest.mark.parametrize('messages', (FALSE, BACK), ids=('false stamps', 'set back'))
def test_replay_is_that_of_a_live_session(tmp_path: Path, messages: list[Sent]) -> None:
    session = ContactSession(EstimationParameters(), generate_reference=False)
    inputs, live = MessageInputs(session), []
    for _, topic, raw in messages:
        process = inputs.process_wrench if topic == '/wrench' else inputs.process_motion
        live += [repr(result.estimates) for result in process(raw)]
    assert replayed(tmp_path / 'a.mcap', messages) == (live, session.rejected)
    assert len(live) > 1700
