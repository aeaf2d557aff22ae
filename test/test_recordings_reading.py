# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings are read whole, damaged, and by rosbags."""

import os
from pathlib import Path
import subprocess
import sys
from typing import Any

from contact_estimation.commands.replay import main as replay
from contact_estimation.exceptions import MissingPackageError, RecordingError
from contact_estimation.pipeline.events import EstimationEvent, START
from contact_estimation.recordings import (
    chunk_reader, RecordingReader, RecordingWriter, rosbags_file)
from contact_estimation.recordings.encoding import encode_string, JointStateEncoder, WrenchEncoder
from contact_estimation.recordings.source import require_topics
from core_runs import contact_samples
import mcap.exceptions
import mcap.stream_reader
from mcap.writer import CompressionType
from mcap_files import ends_of_batches, numbers, plain_file, STRING
import numpy as np
import pytest

PEAK_MEMORY = """
import resource, sys
from contact_estimation.recordings import RecordingReader
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
count = sum(1 for _ in RecordingReader(sys.argv[1]).messages())
print(count, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


@pytest.mark.parametrize('compression', list(CompressionType))
@pytest.mark.parametrize('chunked', [True, False])
@pytest.mark.parametrize('finish', [True, False])
def test_every_kind_of_file_is_read(
    tmp_path: Path, compression: Any, chunked: Any, finish: Any
) -> None:
    path = plain_file(tmp_path / 'a.mcap', compression=compression, use_chunking=chunked,
                      finish=finish)
    reader = RecordingReader(path)
    assert reader.topics() == {'/even': STRING, '/odd': STRING}
    assert numbers(reader) == list(range(300))
    assert numbers(reader, ['odd']) == list(range(1, 300, 2))
    assert reader.metadata() == {'parameters': {'a': '1'}}
    assert (reader.truncated, reader.damaged_chunks, reader.progress) == (not finish, 0, 1.0)


@pytest.mark.slow
def test_ten_times_the_messages_need_the_same_memory(tmp_path: Path) -> None:
    peaks = []
    for count in (20_000, 200_000):
        path = tmp_path / f'{count}.mcap'
        with RecordingWriter.file(path) as writer:
            for k in range(count):
                writer.write('/a', STRING, k.to_bytes(100, 'little'), k * 1_000_000)
        environment = dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path))
        done = subprocess.run([sys.executable, '-c', PEAK_MEMORY, str(path)], env=environment,
                              stdout=subprocess.PIPE, check=True)
        found, kilobytes = map(int, done.stdout.split())
        assert found == count
        peaks.append(kilobytes)
    assert peaks[1] - peaks[0] < 3000


def test_split_bag_is_read_in_the_order_of_its_metadata(tmp_path: Path) -> None:
    folder = tmp_path / 'bag'
    folder.mkdir()
    plain_file(folder / 'bag_1.mcap', 10)
    plain_file(folder / 'bag_0.mcap', 20)
    (folder / 'metadata.yaml').write_text(
        'rosbag2_bagfile_information: {version: 9, storage_identifier: mcap, '
        'relative_file_paths: [bag_1.mcap, bag_0.mcap]}')
    assert numbers(RecordingReader(folder)) == [*range(10), *range(20)]


def test_missing_empty_and_ambiguous_places_are_named(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match='does not exist'):
        RecordingReader(tmp_path / 'nowhere')
    with pytest.raises(RecordingError, match='holds no recording: .* got nothing'):
        RecordingReader(tmp_path)
    for name in ('a.mcap', 'b.mcap', 'a.json'):
        (tmp_path / name).touch()
    with pytest.raises(RecordingError, match=r'several recordings \(a.mcap, b.mcap\)'):
        RecordingReader(tmp_path)


def test_missing_topic_lists_those_that_are_there(tmp_path: Path) -> None:
    reader = RecordingReader(plain_file(tmp_path / 'a.mcap'))
    with pytest.raises(RecordingError, match='has no topic /wrench; it has: /even .*/odd') as e:
        reader.messages(['wrench', 'odd'])
    assert '--topic wrench:=/name' in str(e.value)


@pytest.mark.parametrize('types, told', [
    ({'/joint_states': 'sensor_msgs/msg/JointState'}, True),
    ({'/joint_states': 'sensor_msgs/msg/JointState', '/ft': 'geometry_msgs/msg/Wrench'}, False),
    ({'/odom': 'nav_msgs/msg/Odometry'}, False)])
def test_joint_states_alone_may_be_of_an_arm_without_a_force_sensor(
    types: dict[str, str], told: bool
) -> None:
    with pytest.raises(RecordingError) as error:
        require_topics(['/wrench'], types, 'it')
    assert ('set wrench_source to joint_efforts' in str(error.value)) == told


def test_reading_imports_neither_estimators_nor_rosbags() -> None:
    code = (
        'import sys, contact_estimation.recordings.recorded_signals; '
        'print([m for m in sys.modules if m.startswith(("contact_estimation.esti", "rosbags"))])')
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path))
    done = subprocess.run([sys.executable, '-c', code], env=environment, check=True,
                          stdout=subprocess.PIPE)
    assert done.stdout.strip() == b'[]'


@pytest.mark.slow
@pytest.mark.parametrize('compression, chunked', [
    (CompressionType.ZSTD, True), (CompressionType.NONE, True), (CompressionType.NONE, False)])
def test_cut_anywhere_keeps_all_complete_chunks(
    tmp_path: Path, compression: Any, chunked: Any
) -> None:
    whole = plain_file(tmp_path / 'whole.mcap', 120, compression, use_chunking=chunked)
    content = whole.read_bytes()
    complete = ends_of_batches(whole) if chunked else {}
    cut = tmp_path / 'cut.mcap'
    for size in range(0, len(content), 7):
        cut.write_bytes(content[:size])
        try:
            reader = RecordingReader(cut)
            found = numbers(reader)
        except RecordingError:
            assert size < 8
            continue
        least = max((count for end, count in complete.items() if end <= size), default=0)
        assert found == list(range(len(found)))
        assert len(found) >= least
        assert reader.truncated
        assert reader.damaged_chunks == 0
        reader.metadata(), reader.topics(), reader.start_ns


@pytest.mark.parametrize('chunked', [True, False])
@pytest.mark.parametrize('change', ['overwrite', 'remove', 'insert'])
def test_garbage_anywhere_is_survived(tmp_path: Path, chunked: Any, change: Any) -> None:
    path = plain_file(tmp_path / 'a.mcap', 200, use_chunking=chunked)
    content = path.read_bytes()
    rng = np.random.default_rng(1)
    for at in rng.integers(600, len(content) - 2000, 60):
        before, after = content[:at], content[at + 30 * (change != 'insert'):]
        path.write_bytes(before + (b'' if change == 'remove' else rng.bytes(30)) + after)
        reader = RecordingReader(path)
        found = [k for k in numbers(reader) if k < 200]
        assert len(found) > 200 - 3 * 25
        assert found == sorted(found)
        reader.metadata(), reader.topics()


@pytest.mark.parametrize('content, text', [
    (b'', 'is empty'),
    (b'just some text', 'no MCAP file: expected .* got'),
    (b'#ROSBAG V2.0\n', 'ROS 1 bag'),
    (b'\x89MCAP', 'no MCAP file')])
def test_files_that_are_no_recording_are_named(tmp_path: Path, content: Any, text: Any) -> None:
    (tmp_path / 'a.mcap').write_bytes(content)
    with pytest.raises(RecordingError, match=text) as caught:
        RecordingReader(tmp_path / 'a.mcap')
    assert '\n' not in str(caught.value)


def test_missing_decompressor_is_named_and_not_taken_for_damage(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not hasattr(mcap.exceptions, 'UnsupportedCompressionError'):
        pytest.skip('this mcap cannot be imported without its decompressors')
    path = plain_file(tmp_path / 'a.mcap', compression=CompressionType.LZ4)
    monkeypatch.setattr(mcap.stream_reader, 'lz4', None)
    with pytest.raises(MissingPackageError, match='lz4'):
        numbers(RecordingReader(path))


rosbag2 = pytest.importorskip('rosbags.rosbag2')
typesys = pytest.importorskip('rosbags.typesys')

FORMATS = [('SQLITE3', None), ('SQLITE3', 'FILE'), ('SQLITE3', 'MESSAGE'), ('MCAP', 'FILE'),
           ('MCAP', 'MESSAGE')]
SAMPLES = contact_samples(1.0, 5000.0, 100.0, force_noise=0.6)
TYPES = {'/wrench': 'geometry_msgs/msg/WrenchStamped',
         '/joint_states': 'sensor_msgs/msg/JointState',
         '/estimator_node/events': 'std_msgs/msg/String'}


def messages(**parameters: Any) -> list[tuple[str, int, bytes]]:
    """Make what a recorder would receive."""
    start = EstimationEvent(START, -(2**63), parameters)
    found = [('/estimator_node/events', 0, encode_string(start.to_text()))]
    wrenches, joints = WrenchEncoder('tool'), JointStateEncoder('tool', 'x', True)
    for stamp, x, v, F in SAMPLES:
        found.append(('/joint_states', stamp, joints.encode(stamp, x, v)))
        found.append(('/wrench', stamp, wrenches.encode(stamp, F, 0.0, 0.0)))
    return found


def write(folder: Path, storage: str, mode: str | None, **parameters: Any) -> Path:
    """Write a bag with rosbags."""
    store = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)
    writer = rosbag2.Writer(
        folder, version=9, storage_plugin=getattr(rosbag2.StoragePlugin, storage))
    if mode:
        writer.set_compression(
            getattr(writer.CompressionMode, mode)
            if hasattr(writer, 'CompressionMode') else getattr(rosbag2.CompressionMode, mode),
            rosbag2.CompressionFormat.ZSTD)
    with writer:
        connections = {topic: writer.add_connection(topic, kind, typestore=store)
                       for topic, kind in TYPES.items()}
        for topic, stamp, raw in messages(**parameters):
            writer.write(connections[topic], stamp, raw)
    return folder


@pytest.mark.parametrize('storage, mode', FORMATS)
def test_every_message_and_topic_is_read(tmp_path: Path, storage: str, mode: str | None) -> None:
    reader = RecordingReader(write(tmp_path / 'bag', storage, mode))
    assert reader.topics() == TYPES
    assert sorted(map(tuple, reader.messages(['wrench']))) == sorted(
        ('wrench', stamp, raw) for topic, stamp, raw in messages() if topic == '/wrench')
    assert len(list(reader.messages())) == len(messages())
    assert (reader.start_ns, reader.end_ns) == (0, SAMPLES[-1].stamp_ns)
    assert reader.progress == 1.0


def test_database_without_its_folder_is_read(tmp_path: Path) -> None:
    (file,) = write(tmp_path / 'bag', 'SQLITE3', None).glob('*.db3')
    assert len(list(RecordingReader(file).messages())) == len(messages())


def test_replay_of_a_database_takes_the_parameters_of_the_start(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert replay([str(write(tmp_path / 'bag', 'SQLITE3', 'FILE', estimator='kalman'))]) == 0
    assert capsys.readouterr().out.startswith('kalman: 750 samples')


def test_without_rosbags_the_error_says_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = write(tmp_path / 'bag', 'SQLITE3', None)
    monkeypatch.setitem(sys.modules, 'rosbags.rosbag2', None)
    with pytest.raises(MissingPackageError, match='pip install rosbags'):
        RecordingReader(bag)


def test_a_bag_that_decompresses_to_more_than_its_limit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = write(tmp_path / 'bag', 'SQLITE3', 'FILE')
    monkeypatch.setattr(rosbags_file, 'LARGEST_FILE', 1000)
    with pytest.raises(RecordingError, match='more than the limit .* ros2 bag convert'):
        RecordingReader(bag).topics()


@pytest.mark.parametrize('storage', ['SQLITE3', 'MCAP'])
def test_messages_that_decompress_to_more_than_the_limit_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, storage: str
) -> None:
    bag = write(tmp_path / 'bag', storage, 'MESSAGE')
    monkeypatch.setattr(chunk_reader, 'LARGEST_CHUNK', 5000)
    with pytest.raises(RecordingError, match='expected at most'):
        list(RecordingReader(bag).messages())


def test_compressed_messages_are_read_without_the_metadata_of_the_bag(tmp_path: Path) -> None:
    (file,) = write(tmp_path / 'bag', 'MCAP', 'MESSAGE').glob('*.mcap')
    assert sorted(map(tuple, RecordingReader(file).messages())) == sorted(messages())
