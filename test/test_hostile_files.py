# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Damaged or hostile files: one printable line, and no more memory than a stated limit."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from contact_estimation.exceptions import ContactEstimationError, RecordingError
from contact_estimation.kinematics.description import read_description
from contact_estimation.parameter_files import read_parameter_file
from contact_estimation.pipeline.events import EstimationEvent
from contact_estimation.recordings import chunk_reader, RecordingReader
from contact_estimation.texts import printable
from mcap.writer import CompressionType
from mcap_files import numbers, plain_file
import pytest


@pytest.mark.parametrize('content, text', [
    ('a: !!bool foo', "'foo' is no bool"),
    ('a: !!int abc', "'abc' is no int of 64 bits"),
    ('a: 2001-99-99', "'2001-99-99' is no timestamp"),
    (f'a: {"9" * 5000}', 'is no int of 64 bits'),
    ('[' * 100_000, 'more than 50 levels deep'),
    ('a: &a [*a]', r'alias \*a is part of itself'),
    ('a: &a [1, 1, 1]\n' + ''.join(
        f'{y}: &{y} [*{x}, *{x}, *{x}, *{x}, *{x}]\n' for x, y in zip('abcdefgh', 'bcdefghi')),
     'more than 100000 values'),
    ('#' * (1 << 21), 'at most 1048576 bytes'),
    ('version https://git-lfs.github.com/spec/v1', 'git lfs pull'),
])
def test_yaml_that_python_cannot_hold_is_named(tmp_path: Path, content: str, text: str) -> None:
    (tmp_path / 'a.yaml').write_text(content)
    with pytest.raises(ContactEstimationError, match=f'a.yaml cannot be read: .*{text}'):
        read_parameter_file(tmp_path / 'a.yaml', 'estimator_node')


@pytest.mark.parametrize('event, parameters', [
    ('tare', '{}'), ('tare', '{"force_bias": "abc"}'), ('tare', '{"force_bias": NaN}'),
    ('robot_description', '{}'), ('arm_ready', '{"wrench_ns": 1}'),
    ('static_transforms', '{"transforms": [["a", "b", 1]]}'), ('reset', '[' * 100_000),
])
def test_recorded_event_that_cannot_be_repeated_is_refused(event: str, parameters: str) -> None:
    text = (f'{{"event": "{event}", "after_stamp_ns": 0, "time_jumps": 0, '
            f'"parameters": {parameters}}}')
    with pytest.raises(RecordingError, match='expected an estimation event'):
        EstimationEvent.from_text(text)


def test_texts_of_files_are_printed_escaped_and_in_bounds() -> None:
    assert str(RecordingError('a\x1b[2J\nb\u202ec')) == r'a\x1b[2J\nb\u202ec'
    assert printable('\udcff') == r'\xff'
    assert len(str(RecordingError('a' * 10**6))) < 5000
    assert printable('schräg 力') == 'schräg 力'


@pytest.mark.parametrize('compression', [CompressionType.ZSTD, CompressionType.LZ4])
def test_chunk_beyond_the_limit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compression: Any
) -> None:
    path = plain_file(tmp_path / 'a.mcap', compression=compression)
    monkeypatch.setattr(chunk_reader, 'LARGEST_CHUNK', 100)
    with pytest.raises(RecordingError, match='MiB decompressed, expected at most'):
        numbers(RecordingReader(path))


@pytest.mark.parametrize('compression', [CompressionType.ZSTD, CompressionType.LZ4])
def test_chunk_that_holds_more_than_it_states_is_damage(
    tmp_path: Path, compression: Any
) -> None:
    content = bytearray(plain_file(
        tmp_path / 'a.mcap', compression=compression, finish=False).read_bytes())
    name = content.rindex(compression.name.lower().encode())
    content[name - 16:name - 8] = (10).to_bytes(8, 'little')  # uncompressed_size
    (tmp_path / 'a.mcap').write_bytes(content)
    reader = RecordingReader(tmp_path / 'a.mcap')
    assert numbers(reader)[0] == 0
    assert reader.damaged_chunks == 1


@pytest.mark.parametrize('name', ['a.mcap', 'a.csv', 'a.parquet', 'a.mat', 'a.db3', 'a.urdf'])
def test_git_lfs_pointer_and_pipe_are_named(tmp_path: Path, name: str) -> None:
    read = read_description if name == 'a.urdf' else RecordingReader
    (tmp_path / name).write_text('version https://git-lfs.github.com/spec/v1\n')
    with pytest.raises(ContactEstimationError, match='Git LFS pointer; .* git lfs pull'):
        read(tmp_path / name)
    (tmp_path / 'pipe').mkdir()
    os.mkfifo(tmp_path / 'pipe' / name)
    with pytest.raises(ContactEstimationError, match='got a folder, pipe or device'):
        read(tmp_path / 'pipe' / name)
