# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings that only the package rosbags reads: SQLite, and what rosbag2 compresses itself."""

from contextlib import contextmanager
from functools import cached_property, partial
from pathlib import Path
from shutil import disk_usage
from tempfile import gettempdir
from typing import Any, Collection, Iterator, Mapping

from mcap import stream_reader

from .chunk_reader import RecordedMessage
from .mcap_records import Summary
from .source import canonical
from ..exceptions import MissingPackageError, RecordingError

_BATCH = 1000  # messages
LARGEST_FILE = 1 << 35
"""Of a bag that rosbag2 compressed as a whole, decompressed [bytes]: 32 GiB, several hours."""
_BLOCK = 1 << 22


class RosbagsFile:
    """
    Read a rosbag2 folder or a .db3 file, with the interface of `McapFile`.

    Such recordings are read when complete only, and hold no metadata records.

    size, position: number of messages, and of those read in the current pass
    definitions: of each type
    damaged, hidden: always 0: damage is an error
    summary: says that the recording is complete
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.position = self.damaged = self.hidden = 0
        self.summary = Summary(whole=True)
        if path.is_dir() and stream_reader.zstandard:
            for file in sorted(path.glob('*.zstd')):
                _require_size(file, stream_reader.zstandard)
        with self._opened() as reader:
            self.size = max(1, int(reader.message_count))
            self._types = {str(c.topic): str(c.msgtype) for c in reader.connections}
            self.definitions = {str(c.msgtype): str(c.msgdef.data) for c in reader.connections}
            self._span = int(reader.start_time), int(reader.end_time) - 1
            self._empty = reader.message_count == 0

    def batches(self, wanted: Mapping[str, str] | None) -> Iterator[list[RecordedMessage]]:
        self.position = 0
        with self._opened() as reader:
            names = {c.id: (c.topic if wanted is None else wanted[canonical(c.topic)])
                     for c in reader.connections
                     if wanted is None or canonical(c.topic) in wanted}
            chosen = [c for c in reader.connections if c.id in names]
            batch: list[RecordedMessage] = []
            for connection, log_time_ns, data in reader.messages(chosen) if chosen else ():
                batch.append(RecordedMessage(names[connection.id], int(log_time_ns), bytes(data)))
                if len(batch) == _BATCH:
                    self.position += len(batch)
                    yield batch
                    batch = []
            if batch:
                yield batch
        self.position = self.size

    def topics(self, asked: Collection[str] | None) -> dict[str, str]:
        """Return the type of each topic."""
        return dict(self._types)

    def metadata(self) -> dict[str, dict[str, str]]:
        """Return no records: rosbags does not read any."""
        return {}

    def time_span(self) -> tuple[int, int] | None:
        """Return the log times of the first and the last message [ns], None without any."""
        return None if self._empty else self._span

    @cached_property
    def _reader_class(self) -> Any:
        try:
            from rosbags.rosbag2 import Reader
        except ImportError as error:
            raise MissingPackageError.of(
                'rosbags', f'reading {self.path}, which is SQLite or compressed by rosbag2,'
            ) from error
        return Reader

    @contextmanager
    def _opened(self) -> Iterator[Any]:
        reader_class = self._reader_class
        try:
            with reader_class(self.path) as reader:
                yield reader
        except RecordingError:
            raise
        except Exception as error:  # of rosbags, apsw and each decompressor
            raise RecordingError(
                f'rosbags cannot read recording {self.path}: {" ".join(str(error).split())}; '
                'check that it was closed properly, or convert it with ros2 bag convert'
            ) from error


def _require_size(file: Path, zstandard: Any) -> None:
    """Require that a compressed file, which rosbags writes to a temporary folder, has room."""
    folder = gettempdir()
    free = disk_usage(folder).free
    most, size = min(LARGEST_FILE, free), 0
    with open(file, 'rb') as stream:
        try:
            for block in iter(partial(zstandard.ZstdDecompressor().stream_reader(
                    stream, read_across_frames=True).read, _BLOCK), b''):
                size += len(block)
                if size > most:
                    break
        except zstandard.ZstdError:
            return  # rosbags names the damage
    if size > most:
        limit = f'the limit of {LARGEST_FILE >> 30} GiB' if most == LARGEST_FILE else (
            f'the {free >> 20} MiB that are free in {folder}')
        raise RecordingError(
            f'{file} takes more than {limit} decompressed; convert it to MCAP with chunks: '
            'ros2 bag convert')
