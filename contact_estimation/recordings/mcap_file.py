# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Messages, topics and metadata of one MCAP file, complete, cut, or still growing."""

from contextlib import contextmanager
from copy import copy
from functools import cached_property
from pathlib import Path
from struct import Struct
from typing import BinaryIO, Collection, Iterable, Iterator, Mapping

from mcap.opcode import Opcode
from mcap.records import Metadata

from .chunk_reader import Channels, parsed, read_chunk, RecordedMessage, walk
from .mcap_records import ENDS, MAGIC, read_summary, Record, RECORD_HEAD, RecordScanner, Summary
from .source import canonical
from ..exceptions import RecordingError

_BLOCK = 1 << 20
_LOOSE = (Opcode.MESSAGE, Opcode.SCHEMA, Opcode.CHANNEL)
_TIMES = Struct('<QQ')  # of the first and last message of a chunk


class McapFile:
    """
    Read one file, which is opened anew for each pass.

    size: bytes at the time of opening
    position: end of the bytes read in the current or last pass over the messages
    damaged: chunks and records skipped in that pass
    definitions: of the types found by the last search for topics
    hidden: those skipped in the last search for topics, some of which they may describe
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.position = 0
        self.damaged = self.hidden = 0
        self.definitions: dict[str, str] = {}
        with _opened(path) as stream:
            start = stream.read(len(MAGIC))
            self.size = stream.seek(0, 2)
            _require_magic(path, start, self.size)
            self.summary = read_summary(stream, self.size)

    def batches(self, wanted: Mapping[str, str] | None) -> Iterator[list[RecordedMessage]]:
        """Read the messages, a chunk at a time."""
        return filter(None, self._stretches(Channels(wanted)))

    def topics(self, asked: Collection[str] | None) -> dict[str, str]:
        """Find the topics and their types."""
        channels = Channels({})
        self.definitions = channels.definitions
        self._describe(channels)
        if self.summary.complete:
            return channels.types
        missing = None if asked is None else {canonical(topic) for topic in asked}
        other = copy(self)  # progress and damage of this one stay
        for _ in other._stretches(channels):
            if missing is not None and missing <= {canonical(topic) for topic in channels.types}:
                break
        self.hidden = other.damaged
        return channels.types

    def metadata(self) -> dict[str, dict[str, str]]:
        """Read the metadata records; where several have one name, later values count."""
        places = (self.summary if self.summary.complete else self._survey).metadata
        found: dict[str, dict[str, str]] = {}
        with _opened(self.path) as stream:
            for place in places:
                stream.seek(place.start + RECORD_HEAD.size)
                record = parsed(Metadata, stream.read(place.end - place.start - RECORD_HEAD.size))
                if record is not None:  # damaged ones are skipped: the others are still of use
                    found.setdefault(record.name, {}).update(record.metadata)
        return found

    def time_span(self) -> tuple[int, int] | None:
        """Return the log times of the first and the last message [ns], None if unknown."""
        return self.summary.span_ns or self._survey.span_ns

    @cached_property
    def _survey(self) -> Summary:
        """Find metadata and time span where the summary does not list them."""
        places: list[Record] = []
        spans: list[tuple[int, int]] = []
        with _opened(self.path) as stream:
            scanner = RecordScanner(stream, self.size)
            for record in scanner:
                if record.opcode == Opcode.CHUNK:
                    scanner.check(intact=True)
                    begin = record.start + RECORD_HEAD.size
                    spans.append(_TIMES.unpack(scanner.read(begin, begin + _TIMES.size)))
                elif record.opcode == Opcode.METADATA:
                    places.append(record)
        found = Summary(metadata=places)
        if spans:
            found.span_ns = min(begin for begin, _ in spans), max(end for _, end in spans)
        return found

    def _describe(self, channels: Channels) -> None:
        """Add the channels of the summary, so that damage to their chunk does no harm."""
        for record in self.summary.descriptions:
            channels.add(record)

    def _stretches(self, channels: Channels) -> Iterator[list[RecordedMessage]]:
        """Read all that may hold messages or channels: by the index, else record by record."""
        self._describe(channels)
        self.damaged = 0
        # Without chunks there are no messages, or all stand outside chunks.
        indexed = self.summary.complete and self.summary.chunks
        with _opened(self.path) as stream:
            yield from (self._indexed if indexed else self._scanned)(stream, channels)
        self.position = self.size

    def _indexed(self, stream: BinaryIO, channels: Channels) -> Iterator[list[RecordedMessage]]:
        """Read the chunks that hold a wanted channel."""
        for start, end, _, present in self.summary.chunks:
            if present and present.isdisjoint(channels.handed_out):
                continue
            stream.seek(start + RECORD_HEAD.size)
            messages = read_chunk(stream.read(end - start - RECORD_HEAD.size), channels)
            self.damaged += messages is None
            self.position = end
            yield messages or []

    def _scanned(self, stream: BinaryIO, channels: Channels) -> Iterator[list[RecordedMessage]]:
        """Read record by record up to the end or a cut."""
        scanner = RecordScanner(stream, self.size)
        for record in scanner:
            if record.opcode == Opcode.CHUNK:
                messages = read_chunk(scanner.content(record), channels)
                scanner.check(intact=messages is not None)
            elif record.opcode in _LOOSE:
                messages = _loose_messages(scanner, record, channels)
            else:
                continue
            self.position, self.damaged = scanner.position, scanner.damaged
            yield messages or []
        self.damaged = scanner.damaged


def _loose_messages(
    scanner: RecordScanner, record: Record, channels: Channels
) -> list[RecordedMessage]:
    """Read records that stand outside chunks, a block of them at a time."""
    block = scanner.read(record.start, max(record.start + _BLOCK, record.end))
    result = walk(block, channels)
    if result.end:
        scanner.move(record.start + result.end, record.start + result.last)
    return result.messages


def _require_magic(path: Path, start: bytes, size: int) -> None:
    """Raise an error that names the kind of a file that is not MCAP."""
    if start.startswith(MAGIC):
        return
    if size == 0:
        raise RecordingError(
            f'recording {path} is empty (0 bytes), expected an MCAP file; '
            'it was stopped before its first message: record again')
    if start.startswith(b'#ROSBAG'):
        raise RecordingError(
            f'recording {path} is a ROS 1 bag, expected an MCAP file; '
            f'convert it with: rosbags-convert --src {path} --dst NEW_FOLDER --dst-storage mcap')
    raise RecordingError(
        f'{path} is no MCAP file: expected it to begin with {MAGIC!r}, got {start[:8]!r}; '
        'give a .mcap file or a rosbag2 folder')


@contextmanager
def _opened(path: Path) -> Iterator[BinaryIO]:
    """Open a file for reading; report errors of the file system."""
    try:
        with open(path, 'rb') as stream:
            yield stream
    except OSError as error:
        raise RecordingError(
            f'cannot read recording {path}: {error.strerror}; give an existing .mcap file or '
            'rosbag2 folder and check disk and permissions') from error


class GrowingRecording:
    """
    Read the messages that a recorder has flushed since the last call.

    It needs no subscription, so it does not affect the recorded nodes.

    finished: whether the recorder has ended the file
    """

    def __init__(self, path: Path, topics: Iterable[str]) -> None:
        self._path, self._position = path, len(MAGIC)
        self._channels = Channels({canonical(topic): topic for topic in topics})
        self.finished = False

    def new_messages(self) -> list[RecordedMessage]:
        """Return what has been added."""
        file = self._file()
        if file is None:
            return []
        messages: list[RecordedMessage] = []
        with open(file, 'rb') as stream:
            size = stream.seek(0, 2)
            if size < self._position:
                return []
            scanner = RecordScanner(stream, size)
            scanner.move(self._position, self._position)
            for record in scanner:
                if record.opcode == Opcode.CHUNK:
                    messages += read_chunk(scanner.content(record), self._channels) or []
                self._position = record.end
            end = scanner.read(self._position, self._position + 1)
            self.finished = bool(end) and end[0] in ENDS
        return messages

    def _file(self) -> Path | None:
        """Return the file that is written; None before its begin."""
        if not self._path.is_dir():
            return self._path if self._path.is_file() else None
        return next(iter(sorted(self._path.glob('*.mcap'))), None)
