# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings written by the package mcap, and what is read of them."""

from pathlib import Path
from typing import Any, Sequence

from contact_estimation.recordings import RecordingReader
from mcap.writer import CompressionType, Writer
import numpy as np

STRING = 'std_msgs/msg/String'


def plain_file(
    path: Path, count: int = 300, compression: CompressionType = CompressionType.ZSTD,
    finish: bool = True, **options: Any,
) -> Path:
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


def numbers(reader: RecordingReader, topics: Sequence[str] | None = None) -> list[int]:
    """Return the numbers that the messages of a plain file hold."""
    return [int.from_bytes(m.data[:8], 'little') for m in reader.messages(topics)]


def ends_of_batches(path: Path) -> dict[int, int]:
    """Map where each chunk ends in the file to the number of messages up to there."""
    reader = RecordingReader(path)
    ends: dict[int, int] = {}
    count = 0
    for batch in reader.batches():
        count += len(batch)
        ends[round(reader.progress * path.stat().st_size)] = count
    return ends
