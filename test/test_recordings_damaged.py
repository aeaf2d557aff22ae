# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings that are cut, damaged or none: what can be read is read, the rest is named."""

from __future__ import annotations

from pathlib import Path
import struct
from typing import Any

from contact_estimation.exceptions import MissingPackageError, RecordingError
from contact_estimation.recordings import RecordingReader, RecordingWriter
import mcap.exceptions
import mcap.stream_reader
from mcap.writer import CompressionType
from mcap_files import ends_of_batches, numbers, plain_file, STRING
import numpy as np
import pytest


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
