# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings that are cut, damaged or none: what can be read is read, the rest is named."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from contact_estimation.exceptions import MissingPackageError, RecordingError
from contact_estimation.recordings import RecordingReader
import mcap.exceptions
import mcap.stream_reader
from mcap.writer import CompressionType
from mcap_files import ends_of_batches, numbers, plain_file
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
    (b'\x89MCAP', 'no MCAP file'),
])
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
