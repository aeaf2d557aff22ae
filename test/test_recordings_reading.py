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

"""Recordings are read whole, cut anywhere or damaged, in bounded memory."""

import os
from pathlib import Path
import struct
import subprocess
import sys
from typing import Any

from contact_estimation.exceptions import MissingPackageError, RecordingError
from contact_estimation.recordings import RecordingReader, RecordingWriter
import mcap.exceptions
import mcap.stream_reader
from mcap.writer import CompressionType, IndexType, Writer
import numpy as np
import pytest

STRING = 'std_msgs/msg/String'

PEAK_MEMORY = """
import resource, sys
from contact_estimation.recordings import RecordingReader
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
count = sum(1 for _ in RecordingReader(sys.argv[1]).messages())
print(count, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


def plain_file(
    path: Any,
    count: Any = 300,
    compression: Any = CompressionType.ZSTD,
    finish: Any = True,
    **options: Any,
) -> Any:
    """Write a file by the package mcap; message k of topic k % 2 holds the number k."""
    options = {'chunk_size': 1000, **options}
    noise = np.random.default_rng(0)
    with open(path, 'wb') as stream:
        writer = Writer(stream, compression=compression, **options)
        writer.start('ros2')
        writer.add_metadata('parameters', {'a': '1'})
        schema = writer.register_schema(STRING, 'ros2msg', b'string data')
        channels = [writer.register_channel(t, 'cdr', schema) for t in ('/even', '/odd')]
        for k in range(count):
            data = k.to_bytes(8, 'little') + noise.bytes(40)
            writer.add_message(channels[k % 2], k, data, k)
        if finish:
            writer.finish()
        else:
            writer.flush()
    return path


def numbers(reader: Any, topics: Any = None) -> Any:
    return [int.from_bytes(m.data[:8], 'little') for m in reader.messages(topics)]


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


def test_file_without_any_index_is_read(tmp_path: Path) -> None:
    path = plain_file(tmp_path / 'a.mcap', index_types=IndexType.NONE, use_statistics=False,
                      use_summary_offsets=False, repeat_channels=False, repeat_schemas=False)
    reader = RecordingReader(path)
    assert len(reader.topics()) == 2
    assert reader.metadata() == {'parameters': {'a': '1'}}
    assert numbers(reader) == list(range(300))
    assert (reader.start_ns, reader.end_ns) == (0, 299)
    assert not reader.truncated


def test_topic_is_handed_out_as_it_was_asked_for(tmp_path: Path) -> None:
    reader = RecordingReader(plain_file(tmp_path / 'a.mcap'))
    assert {message.topic for message in reader.messages(['even', '/odd'])} == {'even', '/odd'}
    assert {message.topic for message in reader.messages()} == {'/even', '/odd'}


def test_batches_hold_the_same_messages(tmp_path: Path) -> None:
    reader = RecordingReader(plain_file(tmp_path / 'a.mcap'))
    batches = list(reader.batches(['odd']))
    assert len(batches) > 10
    assert [m for batch in batches for m in batch] == list(reader.messages(['odd']))


def test_progress_rises_from_chunk_to_chunk(tmp_path: Path) -> None:
    reader = RecordingReader(plain_file(tmp_path / 'a.mcap'))
    steps = [reader.progress for _ in reader.batches()]
    assert steps == sorted(set(steps))
    assert 0 < steps[0] < 0.1


def test_log_times_are_those_of_the_messages(tmp_path: Path) -> None:
    reader = RecordingReader(plain_file(tmp_path / 'a.mcap'))
    assert [m.log_time_ns for m in reader.messages()] == list(range(300))
    assert (reader.start_ns, reader.end_ns) == (0, 299)


@pytest.mark.slow
@pytest.mark.parametrize('compression, chunked', [
    (CompressionType.ZSTD, True), (CompressionType.NONE, True), (CompressionType.NONE, False),
])
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


def ends_of_batches(path: Any) -> Any:
    """Map where each chunk ends in the file to the number of messages up to there."""
    reader = RecordingReader(path)
    ends, count = {}, 0
    for batch in reader.batches():
        count += len(batch)
        ends[round(reader.progress * path.stat().st_size)] = count
    return ends


@pytest.mark.parametrize('compression', list(CompressionType))
@pytest.mark.parametrize('finish', [True, False])
def test_garbage_in_a_chunk_costs_that_chunk(
    tmp_path: Path, compression: Any, finish: Any
) -> None:
    path = plain_file(tmp_path / 'a.mcap', compression=compression, finish=finish)
    ends = list(ends_of_batches(path))
    content = bytearray(path.read_bytes())
    at = ends[4] - 300  # within the data of the fifth chunk
    content[at:at + 50] = bytes(50)
    path.write_bytes(content)
    reader = RecordingReader(path)
    found = numbers(reader)
    lost = sorted(set(range(300)) - set(found))
    assert reader.damaged_chunks == 1
    assert 0 < len(lost) < 25
    assert lost == list(range(lost[0], lost[-1] + 1))


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


def test_damaged_first_chunk_does_not_hide_the_topics(tmp_path: Path) -> None:
    path = plain_file(tmp_path / 'a.mcap')
    content = bytearray(path.read_bytes())
    content[250:300] = bytes(50)
    path.write_bytes(content)
    assert len(numbers(RecordingReader(path), ['even'])) > 100


def test_damaged_summary_is_replaced_by_reading(tmp_path: Path) -> None:
    path = plain_file(tmp_path / 'a.mcap')
    content = bytearray(path.read_bytes())
    content[-400:-300] = bytes(100)
    path.write_bytes(content)
    reader = RecordingReader(path)
    assert len(reader.topics()) == 2
    assert numbers(reader) == list(range(300))


def test_message_outside_the_chunks_is_read_though_no_index_lists_it(tmp_path: Path) -> None:
    path = plain_file(tmp_path / 'a.mcap')
    content = path.read_bytes()
    message = struct.pack('<HIQQ8s', 1, 0, 300, 300, (300).to_bytes(8, 'little'))
    record = struct.pack('<BQ', 5, len(message)) + message
    summary, offsets, _ = struct.unpack('<QQI', content[-28:-8])
    at = summary - 13  # before the record DATA_END
    footer = struct.pack('<QQI', summary + len(record), offsets + len(record), 0)
    path.write_bytes(content[:at] + record + content[at:-28] + footer + content[-8:])
    assert numbers(RecordingReader(path)) == list(range(301))


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
        'relative_file_paths: [bag_1.mcap, bag_0.mcap]}'
    )
    assert numbers(RecordingReader(folder)) == [*range(10), *range(20)]


def test_folder_without_metadata_is_read_in_natural_order(tmp_path: Path) -> None:
    for number, count in ((10, 5), (9, 3)):
        plain_file(tmp_path / f'bag_{number}.mcap', count)
    reader = RecordingReader(tmp_path)
    assert numbers(reader) == [*range(3), *range(5)]
    assert reader.progress == 1.0


def test_folder_that_lacks_a_listed_file_is_refused(tmp_path: Path) -> None:
    with RecordingWriter.folder(tmp_path / 'run'):
        pass
    (tmp_path / 'run' / 'run_0.mcap').unlink()
    with pytest.raises(RecordingError, match='lacks run_0.mcap'):
        RecordingReader(tmp_path / 'run')


def test_damaged_database_names_the_conversion(tmp_path: Path) -> None:
    (tmp_path / 'bag_0.db3').write_bytes(b'SQLite format 3\0' + bytes(100))
    for path in (tmp_path, tmp_path / 'bag_0.db3'):
        with pytest.raises(RecordingError, match='rosbags cannot read .* ros2 bag convert'):
            RecordingReader(path)


@pytest.mark.parametrize('content, text', [
    (b'', 'is empty'),
    (b'just some text', 'no MCAP file: expected .* got'),
    (b'#ROSBAG V2.0\n', 'ROS 1 bag'),
    (b'\x89MCAP', 'no MCAP file'),
])
def test_files_that_are_no_recording_are_named(tmp_path: Path, content: Any, text: Any) -> None:
    (tmp_path / 'a.mcap').write_bytes(content)
    with pytest.raises(RecordingError, match=text) as caught:
        RecordingReader(tmp_path / 'a.mcap')
    assert '\n' not in str(caught.value)


def test_missing_and_empty_places_are_named(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match='does not exist'):
        RecordingReader(tmp_path / 'nowhere')
    with pytest.raises(RecordingError, match='holds no recording: .* got nothing'):
        RecordingReader(tmp_path)


def test_missing_topic_lists_those_that_are_there(tmp_path: Path) -> None:
    reader = RecordingReader(plain_file(tmp_path / 'a.mcap'))
    with pytest.raises(RecordingError, match='has no topic /wrench; it has: /even .*/odd') as e:
        reader.messages(['wrench', 'odd'])
    assert '--topic wrench:=/name' in str(e.value)


def test_similar_topic_is_suggested(tmp_path: Path) -> None:
    path = tmp_path / 'a.mcap'
    with RecordingWriter.file(path) as writer:
        writer.write('/fts/wrench', STRING, b'', 0)
    with pytest.raises(RecordingError, match='--topic wrench:=/fts/wrench'):
        RecordingReader(path).messages(['wrench'])


def test_recording_without_messages_lacks_every_topic(tmp_path: Path) -> None:
    RecordingWriter.folder(tmp_path / 'run').close()
    reader = RecordingReader(tmp_path / 'run')
    assert (list(reader.messages()), reader.topics(), reader.start_ns) == ([], {}, None)
    with pytest.raises(RecordingError, match='it has: no topics'):
        reader.messages(['wrench'])


def test_topics_leave_no_trace_in_progress(tmp_path: Path) -> None:
    reader = RecordingReader(plain_file(tmp_path / 'a.mcap', finish=False))
    reader.topics()
    assert (reader.progress, reader.damaged_chunks) == (0.0, 0)


def test_chunks_without_a_wanted_topic_are_skipped(tmp_path: Path) -> None:
    path = tmp_path / 'a.mcap'
    with RecordingWriter.file(path) as writer:
        for topic, text in (('/a', b'a' * 100), ('/b', b'b' * 100), ('/a', b'c' * 100)):
            writer.write(topic, STRING, text, 0)
            writer.flush()
    ends = list(ends_of_batches(path))
    content = bytearray(path.read_bytes())
    content[ends[1] - 40:ends[1]] = bytes(40)  # damage the chunk of /b
    path.write_bytes(content)
    reader = RecordingReader(path)
    assert [m.data[:1] for m in reader.messages(['/a'])] == [b'a', b'c']
    assert reader.damaged_chunks == 0
    assert [m.data for m in reader.messages(['/b'])] == []
    assert reader.damaged_chunks == 1


def test_reading_imports_neither_estimators_nor_rosbags() -> None:
    code = (
        'import sys, contact_estimation.recordings.recorded_signals; '
        'print([m for m in sys.modules if m.startswith(("contact_estimation.esti", "rosbags"))])'
    )
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path))
    done = subprocess.run([sys.executable, '-c', code], env=environment, check=True,
                          stdout=subprocess.PIPE)
    assert done.stdout.strip() == b'[]'


def test_topics_leave_damage_and_progress_of_a_running_pass(tmp_path: Path) -> None:
    reader = RecordingReader(plain_file(tmp_path / 'a.mcap', finish=False))
    batches = reader.batches()
    next(batches)
    progress = reader.progress
    reader.topics()
    assert reader.progress == progress > 0


def test_missing_decompressor_is_named_and_not_taken_for_damage(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not hasattr(mcap.exceptions, 'UnsupportedCompressionError'):
        pytest.skip('this mcap cannot be imported without its decompressors')
    path = plain_file(tmp_path / 'a.mcap', compression=CompressionType.LZ4)
    monkeypatch.setattr(mcap.stream_reader, 'lz4', None)
    with pytest.raises(MissingPackageError, match='lz4'):
        numbers(RecordingReader(path))
