# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Replay of several axes, and of topics that a recorder received late."""

from __future__ import annotations

from itertools import chain
import json
from math import nan
from pathlib import Path
from typing import Iterable, Sequence

from axes_runs import feed_axes, instants, JOINTS, LOCATIONS, PARAMETERS, session_of_axes
from contact_estimation.commands import replay
from contact_estimation.pipeline.replay import RecordingReplay
from contact_estimation.recordings import RecordingReader, RecordingWriter
from contact_estimation.recordings.encoding import JointStateEncoder, WrenchEncoder
from contact_estimation.recordings.plain_decoding import Vector3StampedDecoder
from contact_estimation.recordings.source import RECORD, RecordingSource, to_metadata
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples
import pytest
from reference_messages import joint_state_bytes, JOINTS as JOINTS_TYPE

SAMPLES = instants(0.3)
COLUMNS = ('stiffness', 'damping', 'stiffness_std', 'damping_std')


@pytest.fixture(scope='module')
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp('axes') / 'a.mcap'
    wrenches = WrenchEncoder('tool')
    with RecordingWriter.file(path) as writer:
        for stamp_ns, positions, velocities, forces in SAMPLES:
            raw = joint_state_bytes(
                ['elbow', *reversed(JOINTS.values())], [9.0, *reversed(positions)],
                [9.0, *reversed(velocities)], stamp_ns=stamp_ns,
            )
            writer.write('/joint_states', JOINTS_TYPE, raw, stamp_ns)
            raw = wrenches.encode(stamp_ns, *forces)
            writer.write('/wrench', 'geometry_msgs/msg/WrenchStamped', raw, stamp_ns)
        writer.write_metadata(RECORD, to_metadata(PARAMETERS))
    return path


def run(*arguments: object) -> int:
    """Run the command in this process."""
    return replay.main([str(argument) for argument in arguments])


def test_csv_has_columns_of_every_axis(recording: Path, tmp_path: Path) -> None:
    assert run(recording, '--csv', tmp_path / 'a.csv') == 0
    header, *rows = (tmp_path / 'a.csv').read_text().splitlines()
    names = [*COLUMNS, 'status']
    assert header.split(',') == ['t', *names, *(f'{n}_{a}' for a in 'yz' for n in names)]
    results = feed_axes(session_of_axes(False), SAMPLES)
    for row, result in zip(rows, results, strict=True):
        own = [[*(repr(getattr(e, n)) for n in COLUMNS), e.status.value]
               for e in result.estimates]
        assert row.split(',')[1:] == sum(own, [])


def test_json_has_an_entry_for_every_axis(recording: Path, tmp_path: Path) -> None:
    assert run(recording, '--json', tmp_path / 'a.json') == 0
    summary = json.loads((tmp_path / 'a.json').read_text())
    last = feed_axes(session_of_axes(False), SAMPLES)[-1]
    for axis, estimate in zip('xyz', last.estimates):
        own = summary['axes'][axis]
        assert (own['stiffness'], own['status']) == (estimate.stiffness, estimate.status.value)
        assert own['location'] == estimate.location
        assert own['location'] == pytest.approx(LOCATIONS[axis], abs=1e-4)  # as found
    assert summary['stiffness'] == summary['axes']['x']['stiffness']


def test_mcap_has_every_axis_in_its_place(recording: Path, tmp_path: Path) -> None:
    assert run(recording, '--output', tmp_path / 'out.mcap') == 0
    decode = Vector3StampedDecoder().decode
    messages = RecordingReader(tmp_path / 'out.mcap').messages(['/estimator_node/damping'])
    vectors = [decode(message.data)[1:] for message in messages]
    results = feed_axes(session_of_axes(False), SAMPLES)
    assert vectors == [tuple(e.damping for e in r.estimates) for r in results]


@pytest.mark.parametrize('given, text', [
    ('y=contact_y', 'AXIS:=JOINT'), ('y:=', 'AXIS:=JOINT'), ('w:=a', 'unknown axis'),
    ('x:=contact_x', 'x is the contact axis'),
])
def test_wrong_further_axis_is_refused(
    recording: Path, capfd: pytest.CaptureFixture[str], given: str, text: str
) -> None:
    assert run(recording, '--further', given) == 1
    lines = capfd.readouterr().err.strip().splitlines()
    assert len(lines) == 1 and text in lines[0]


TYPES = {'/wrench': 'geometry_msgs/msg/WrenchStamped',
         '/joint_states': 'sensor_msgs/msg/JointState'}
BEGIN_NS, PERIOD_NS = 1_750_000_000_000_000_000, 2_000_000
TOUCH = [sample._replace(stamp_ns=BEGIN_NS + sample.stamp_ns)
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


IN_TIME = sent(TOUCH)
BAD = sent([sample._replace(force=nan) if k % 400 == 300 else sample
            for k, sample in enumerate(TOUCH)])
BACK = sent([*TOUCH, *(sample._replace(stamp_ns=sample.stamp_ns - PERIOD_NS // 2)
                       for sample in TOUCH)])

LIES = (lambda ns: 0, lambda ns: ns + 6 * 10**8, lambda ns: ns - 3 * 10**9)
FALSE = sent([sample._replace(stamp_ns=LIES[k % 3](sample.stamp_ns)) if k % 100 == 50 else sample
              for k, sample in enumerate(TOUCH)])

KINDS = {'regular': IN_TIME, 'with NaN': BAD, 'set back': BACK, 'false stamps': FALSE}


@pytest.fixture(scope='module')
def in_time(tmp_path_factory: pytest.TempPathFactory) -> Replayed:
    """Replay each kind of recording without a late topic."""
    folder = tmp_path_factory.mktemp('in_time')
    return {kind: replayed(folder / f'{kind}.mcap', messages) for kind, messages in KINDS.items()}


@pytest.mark.parametrize('kind', KINDS)
@pytest.mark.parametrize('topic, span', [('/wrench', (310, 380)), ('/joint_states', (0, 110))])
def test_replay_is_that_of_the_topic_in_time(
    in_time: Replayed, tmp_path: Path, topic: str, kind: str, span: tuple[int, int]
) -> None:
    delayed = late(KINDS[kind], topic, *span)
    assert delayed != KINDS[kind]
    assert replayed(tmp_path / 'a.mcap', delayed) == in_time[kind]
    assert len(in_time[kind][0]) > 1700 and not in_time[kind][1].get('joint_missing')
