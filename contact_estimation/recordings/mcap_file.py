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

"""One MCAP file, whole or not: its messages, topics and metadata."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any, BinaryIO, Collection, Iterator, Mapping

from .chunk_reader import Channels, read_chunk, RecordedMessage, walk
from .mcap_format import CHANNEL, ContentReader, MAGIC, MESSAGE, SCHEMA
from .mcap_summary import read_summary, Summary, survey
from .record_scanner import Record, RecordScanner
from .topic_names import canonical
from ..exceptions import RecordingError

_BLOCK = 1 << 20


class McapFile:
    """
    Reads one file; it is opened anew for each pass.

    Parameters
    ----------
    path : Path
        The file.

    Attributes
    ----------
    size : int
        Bytes at the time of opening.
    position : int
        How far the current or last pass over the messages came [bytes].
    damaged : int
        Chunks and records skipped in that pass.

    Raises
    ------
    RecordingError
        If this is no MCAP file.

    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.position = 0
        self.damaged = 0
        with _opened(path) as stream:
            start = stream.read(max(len(MAGIC), 16))
            self.size = stream.seek(0, 2)
            _require_magic(path, start, self.size)
            self.summary = read_summary(stream, self.size)

    def batches(self, wanted: Mapping[str, str] | None) -> Iterator[list[RecordedMessage]]:
        """
        Read the messages, a chunk at a time.

        Parameters
        ----------
        wanted : mapping of str to str or None
            Canonical topic names and what to call them; None reads all topics.

        Yields
        ------
        messages : list of RecordedMessage
            In file order, never empty.

        """
        channels = Channels(wanted)
        self.summary.teach(channels)
        for messages in self._walks(channels):
            if messages:
                yield messages

    def topics(self, asked: Collection[str] | None) -> dict[str, str]:
        """
        Find the topics and their types.

        Parameters
        ----------
        asked : collection of str or None
            Where the file has no summary, reading stops once these are found.

        Returns
        -------
        types : dict of str to str
            Type of each topic.

        """
        channels = Channels({})
        self.summary.teach(channels)
        if self.summary.lists_topics:
            return channels.types
        missing = None if asked is None else {canonical(topic) for topic in asked}
        for _ in self._walks(channels):
            if missing is not None and missing <= {canonical(topic) for topic in channels.types}:
                break
        return channels.types

    def metadata(self) -> dict[str, dict[str, str]]:
        """Read the metadata records; where several have one name, later values count."""
        known = self.summary if self.summary.lists_metadata else self._survey
        found: dict[str, dict[str, str]] = {}
        with _opened(self.path) as stream:
            for place, length in known.metadata_at:
                stream.seek(place)
                fields = ContentReader(stream.read(length))
                try:
                    found.setdefault(fields.text(), {}).update(fields.texts())
                except ValueError:
                    continue  # damaged: the others are still of use
        return found

    def time_span(self) -> tuple[int, int] | None:
        """Return the log times of the first and the last message [ns], None if unknown."""
        known = self.summary if self.summary.start_ns is not None else self._survey
        if known.start_ns is None or known.end_ns is None:
            return None
        return known.start_ns, known.end_ns

    @functools.cached_property
    def _survey(self) -> Summary:
        """Look through a file whose summary does not tell."""
        with _opened(self.path) as stream:
            return survey(RecordScanner(stream, self.size))

    def _walks(self, channels: Channels) -> Iterator[list[RecordedMessage]]:
        """Read all that may hold messages or channels."""
        with _opened(self.path) as stream:
            scanner = RecordScanner(stream, self.size)
            self.damaged = 0
            while (record := scanner.advance()) is not None:
                if record.chunk is not None:
                    messages = _chunk_messages(scanner, record, channels)
                elif record.opcode in (MESSAGE, SCHEMA, CHANNEL):
                    messages = _loose_messages(scanner, record, channels)
                else:
                    continue
                self.position, self.damaged = scanner.position, scanner.damaged
                yield messages
            self.position, self.damaged = self.size, scanner.damaged


def _chunk_messages(
    scanner: RecordScanner, record: Record, channels: Channels
) -> list[RecordedMessage]:
    """Read a chunk; a damaged one is counted and has no messages."""
    assert record.chunk is not None
    result = read_chunk(scanner.read(record.content, record.length), record.chunk, channels)
    if result is None:
        scanner.reject()
        return []
    scanner.confirm()
    return result.messages


def _loose_messages(
    scanner: RecordScanner, record: Record, channels: Channels
) -> list[RecordedMessage]:
    """Read records that stand outside chunks, a block of them at a time."""
    block = scanner.read(record.start, max(_BLOCK, record.end - record.start))
    result = walk(block, channels)
    if result.end:
        scanner.move(record.start + result.end, record.start + result.last)
    return result.messages


def _require_magic(path: Path, start: bytes, size: int) -> None:
    """Explain what a file is that is no MCAP file."""
    if start.startswith(MAGIC):
        return
    if size == 0:
        raise RecordingError(
            f'recording {path} is empty (0 bytes), expected an MCAP file; '
            'it was stopped before its first message: record again'
        )
    if start.startswith(b'SQLite format 3'):
        raise database_error(path)
    if start.startswith(b'#ROSBAG'):
        raise RecordingError(
            f'recording {path} is a ROS 1 bag, expected an MCAP file; '
            f'convert it with: rosbags-convert --src {path} --dst NEW_FOLDER --dst-storage mcap'
        )
    raise RecordingError(
        f'{path} is no MCAP file: expected it to begin with {MAGIC!r}, got {start[:8]!r}; '
        'give a .mcap file or a rosbag2 folder'
    )


def database_error(path: Path) -> RecordingError:
    """Explain how to convert a bag in the older storage format."""
    return RecordingError(
        f'recording {path} is stored as SQLite (.db3), expected MCAP; convert it with: '
        f'ros2 bag convert -i {path} -o options.yaml, where options.yaml says '
        '{output_bags: [{uri: NEW_FOLDER, storage_id: mcap, all_topics: true}]}'
    )


def _opened(path: Path) -> Any:
    """Open a file for reading."""
    try:
        stream: BinaryIO = open(path, 'rb')
    except OSError as error:
        raise RecordingError(
            f'cannot read recording {path}: {error.strerror}; give an existing .mcap file or '
            'rosbag2 folder'
        ) from error
    return stream
