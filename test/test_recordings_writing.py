# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings hold what rosbag2 writes and survive the death of their recorder."""

import os
from pathlib import Path
import signal
import subprocess
import sys
from typing import Any

from contact_estimation.exceptions import RecordingError
from contact_estimation.recordings import OfferedQos, RecordingReader, RecordingWriter
from contact_estimation.recordings.encoding import encode_string, WrenchEncoder
from mcap.reader import make_reader
import pytest
from rosbags.highlevel import AnyReader

WRENCH = 'geometry_msgs/msg/WrenchStamped'
STRING = 'std_msgs/msg/String'
START_NS = 1_750_000_000_000_000_000
PERIOD_NS = 2_000_000

KILLED = """
import os, signal, sys
from contact_estimation.recordings import RecordingWriter
rate_hz, seconds = float(sys.argv[2]), float(sys.argv[3])
writer = RecordingWriter.folder(sys.argv[1])
writer.write_metadata('parameters', {'estimator': 'rls'})
data = bytes([0, 1, 0, 0]) + bytes(72)
for number in range(int(seconds * rate_hz)):
    writer.write('/wrench', 'geometry_msgs/msg/WrenchStamped', data, int(number * 1e9 / rate_hz))
os.kill(os.getpid(), signal.SIGKILL)
"""


def fill(writer: Any, count: Any = 1000) -> None:
    wrench = WrenchEncoder('tool0')
    best_effort = OfferedQos(reliability='best_effort')
    for number in range(count):
        stamp_ns = START_NS + number * PERIOD_NS
        writer.write('/wrench', WRENCH, wrench.encode(stamp_ns, number, 0.0, 0.0), stamp_ns + 5,
                     publish_time_ns=stamp_ns, qos=best_effort)
        if number % 100 == 0:
            writer.write('/status', STRING, encode_string(f'at {number}'), stamp_ns + 6)


@pytest.fixture
def folder(tmp_path: Path) -> Any:
    with RecordingWriter.folder(tmp_path / 'run') as writer:
        writer.write_metadata('parameters', {'estimator': 'rls'})
        fill(writer)
    return tmp_path / 'run'


def test_rosbags_reads_every_message_of_a_folder(folder: Any) -> None:
    with AnyReader([folder]) as opened:
        reader: Any = opened
        assert reader.message_count == 1010
        forces = [
            reader.deserialize(raw, connection.msgtype).wrench.force.x
            for connection, _, raw in reader.messages(reader.connections)
            if connection.topic == '/wrench']
    assert forces == list(range(1000))


def test_rosbags_finds_definition_hash_and_qos(folder: Any) -> None:
    with AnyReader([folder]) as reader:
        connection = next(c for c in reader.connections if c.topic == '/wrench')
        expected = reader.typestore.hash_rihs01(WRENCH)
        assert connection.digest == expected
        assert 'MSG: geometry_msgs/Wrench' in connection.msgdef.data
        extension: Any = connection.ext
        assert extension.offered_qos_profiles[0].reliability.name == 'BEST_EFFORT'


def test_mcap_reads_a_single_file(tmp_path: Path) -> None:
    path = tmp_path / 'out.mcap'
    with RecordingWriter.file(path) as writer:
        fill(writer)
    with open(path, 'rb') as stream:
        reader = make_reader(stream, validate_crcs=True)
        messages = list(reader.iter_messages(['/wrench']))
        summary: Any = reader.get_summary()
        channel = next(c for c in summary.channels.values() if c.topic == '/wrench')
    assert len(messages) == 1000
    assert messages[3][2].publish_time == START_NS + 3 * PERIOD_NS
    assert set(channel.metadata) == {'offered_qos_profiles', 'topic_type_hash'}
    assert not (tmp_path / 'metadata.yaml').exists()


def test_nothing_is_overwritten(folder: Any) -> None:
    with pytest.raises(RecordingError, match='never overwritten'):
        RecordingWriter.folder(folder)
    with pytest.raises(RecordingError, match='never overwritten'):
        RecordingWriter.file(folder / 'run_0.mcap')


def test_full_disk_is_named() -> None:
    if not os.path.exists('/dev/full'):
        pytest.skip('no /dev/full here')
    writer = RecordingWriter.__new__(RecordingWriter)
    with pytest.raises(RecordingError, match='No space left'):
        _use_stream(writer, open('/dev/full', 'wb'))


def _use_stream(writer: Any, stream: Any) -> None:
    """Write to a stream that cannot be created by path."""
    from contact_estimation.recordings import writing
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(writing, 'open', lambda path, mode: stream, raising=False)
        writer.__init__(Path('/tmp/never_created.mcap'), None)


@pytest.mark.slow
@pytest.mark.parametrize('rate_hz, seconds', [(1000, 20), (20, 20), (1, 20)])
def test_kill_loses_at_most_the_last_second(tmp_path: Path, rate_hz: Any, seconds: Any) -> None:
    path = tmp_path / 'run'
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path))
    done = subprocess.run([sys.executable, '-c', KILLED, str(path), str(rate_hz), str(seconds)],
                          env=environment)
    assert done.returncode == -signal.SIGKILL
    reader = RecordingReader(path)
    times = [message.log_time_ns for message in reader.messages(['/wrench'])]
    assert times == [int(k * 1e9 / rate_hz) for k in range(len(times))]
    assert seconds * 1e9 - times[-1] <= 1e9 + 1e9 / rate_hz
    assert reader.truncated
    assert reader.damaged_chunks == 0
    assert reader.metadata() == {'parameters': {'estimator': 'rls'}}
