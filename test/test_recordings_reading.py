# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings are read whole, in any layout, in bounded memory."""

from __future__ import annotations

import os
from pathlib import Path
import subprocess
import sys
from typing import Any

from contact_estimation.exceptions import RecordingError
from contact_estimation.recordings import RecordingReader, RecordingWriter
from mcap.writer import CompressionType
from mcap_files import numbers, plain_file, STRING
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
        'relative_file_paths: [bag_1.mcap, bag_0.mcap]}'
    )
    assert numbers(RecordingReader(folder)) == [*range(10), *range(20)]


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


def test_reading_imports_neither_estimators_nor_rosbags() -> None:
    code = (
        'import sys, contact_estimation.recordings.recorded_signals; '
        'print([m for m in sys.modules if m.startswith(("contact_estimation.esti", "rosbags"))])'
    )
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path))
    done = subprocess.run([sys.executable, '-c', code], env=environment, check=True,
                          stdout=subprocess.PIPE)
    assert done.stdout.strip() == b'[]'
