# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The records of an MCAP file: by its summary, or one after the other across damage and cuts."""

from dataclasses import dataclass, field
from io import BytesIO
import re
from struct import Struct
from typing import BinaryIO, Iterable, Iterator, NamedTuple
import zlib

from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Footer, McapRecord, MetadataIndex, Schema, Statistics
from mcap.stream_reader import StreamReader

from .chunk_reader import parsed

MAGIC = b'\x89MCAP0\r\n'
RECORD_HEAD = Struct('<BQ')  # opcode and length of the content

_CHUNK = int(Opcode.CHUNK)
ENDS = (Opcode.DATA_END, Opcode.FOOTER)
_ANY = 1 << 63
# Shortest content of the records 0x01 to 0x0F; see https://mcap.dev/spec.
_SHORTEST = (8, 20, 14, 16, 22, 40, 6, 64, 36, 48, 46, 8, 20, 17, 4)
_LENGTHS = {
    **{opcode: range(shortest, _ANY) for opcode, shortest in enumerate(_SHORTEST, 1)},
    **{opcode: range(_ANY) for opcode in range(0x80, 0x100)},  # private records
    Opcode.DATA_END: range(4, 5),
    Opcode.FOOTER: range(20, 21),
}
# An opcode and a length below 4 GiB; looking ahead, because candidates may overlap.
_CANDIDATE = re.compile(rb'(?s)(?=[\x02-\x0f].{4}\x00{4})')
_WINDOW = 1 << 20
_LONGEST_NAME = 16


class Record(NamedTuple):
    """Opcode of a record and where it begins and ends in the file."""

    opcode: int
    start: int
    end: int


class RecordScanner:
    """
    Walk over the records of a file; where one is not plausible, search for the next plausible one.

    position: where the next record is expected
    damaged: how often something had to be skipped
    """

    def __init__(self, stream: BinaryIO, size: int) -> None:
        self.position = len(MAGIC)
        self.damaged = 0
        self._stream = stream
        self._size = size
        self._search_from = self.position
        self._counted = False

    def __iter__(self) -> Iterator[Record]:
        """Yield the records up to the end of the data or to where the file is cut."""
        while (record := self._next()) is not None and record.opcode not in ENDS:
            yield record

    def move(self, position: int, last: int) -> None:
        """Continue at `position`; should no record be there, search from just after `last`."""
        self.position = position
        self._search_from = last + 1

    def check(self, intact: bool) -> None:
        """Count the last record as damaged or, if intact, search no record within it."""
        if intact:
            self._search_from = self.position
        else:
            self.damaged += 1
            self._counted = True

    def read(self, start: int, end: int) -> bytes:
        """Read some bytes of the file, fewer at its end."""
        self._stream.seek(start)
        return self._stream.read(max(min(end, self._size) - start, 0))

    def content(self, record: Record) -> bytes:
        """Read the content of a record."""
        return self.read(record.start + RECORD_HEAD.size, record.end)

    def _next(self) -> Record | None:
        """Return the next record."""
        record = self._record_at(self.position)
        if record is None:
            record = self._search()
            self.damaged += record is not None and not self._counted
        if record is None or record.end > self._size:
            return None
        self._counted = False
        self.move(record.end, record.start)
        return record

    def _record_at(self, start: int) -> Record | None:
        """Return the record at some place if it is plausible; only a chunk may be cut."""
        head = self.read(start, start + RECORD_HEAD.size)
        if len(head) < RECORD_HEAD.size:
            return None
        opcode, length = RECORD_HEAD.unpack(head)
        record = Record(opcode, start, start + RECORD_HEAD.size + length)
        if length not in _LENGTHS.get(opcode, ()):
            return None
        plausible = self._is_chunk(record) if opcode == _CHUNK else record.end <= self._size
        return record if plausible else None

    def _is_chunk(self, record: Record) -> bool:
        """Check that the lengths within a chunk agree with that of its record."""
        name = record.start + RECORD_HEAD.size + 32  # behind two times, size, CRC and length
        head = self.read(name - 4, name + _LONGEST_NAME + 8)
        data = 4 + int.from_bytes(head[:4], 'little')
        length = int.from_bytes(head[data:data + 8], 'little')
        return data + 8 <= len(head) and name + data + 4 + length == record.end

    def _search(self) -> Record | None:
        """Find the next place from which on the records are plausible."""
        for start in range(self._search_from, self._size, _WINDOW):
            window = self.read(start, start + _WINDOW + RECORD_HEAD.size)
            for candidate in _CANDIDATE.finditer(window):
                record = self._record_at(start + candidate.start())
                if record is not None and self._is_followed(record):
                    return record
        return None

    def _is_followed(self, record: Record) -> bool:
        """Check the next two records, or that the file ends there."""
        following: Record | None = record
        for _ in range(2):
            # The lengths within a chunk do not agree by accident.
            if following is None or following.opcode == _CHUNK:
                return following is not None
            if following.end in (self._size, self._size - len(MAGIC)):
                return True
            following = self._record_at(following.end)
        return following is not None


_FOOTER_HEAD = RECORD_HEAD.pack(Opcode.FOOTER, 20)
_TAIL = len(_FOOTER_HEAD) + 20 + len(MAGIC)
_AFTER_CRC = 4 + len(MAGIC)


class ChunkPlace(NamedTuple):
    """
    A chunk in the file, and its channels; none are known where it has no message index.

    Its message index ends at `next_record`.
    """

    start: int
    end: int
    next_record: int
    channels: frozenset[int]


@dataclass
class Summary:
    """What is known about a file without reading its messages."""

    whole: bool = False  # the file ends as it should; False where its recorder was killed
    descriptions: list[Schema | Channel] = field(default_factory=list)  # those listed
    # all channels, chunks and metadata records are listed, and no message is outside chunks
    complete: bool = False
    chunks: list[ChunkPlace] = field(default_factory=list)  # in file order
    metadata: list[Record] = field(default_factory=list)  # metadata records
    # log times of the first and the last message [ns]; None if there is no message or the times
    # are not known
    span_ns: tuple[int, int] | None = None


def read_summary(stream: BinaryIO, size: int) -> Summary:
    """Read the summary of a file."""
    stream.seek(max(size - _TAIL, 0))
    tail = stream.read(_TAIL)
    if not (tail.startswith(_FOOTER_HEAD) and tail.endswith(MAGIC) and len(tail) == _TAIL):
        return Summary()
    footer: Footer = parsed(Footer, tail[len(_FOOTER_HEAD):])
    if not len(MAGIC) <= footer.summary_start <= size - _TAIL:
        return Summary(whole=True)
    stream.seek(footer.summary_start)
    content = stream.read(size - footer.summary_start)
    if footer.summary_crc and zlib.crc32(content[:-_AFTER_CRC]) != footer.summary_crc:
        return Summary(whole=True)
    try:
        found = _collected(StreamReader(BytesIO(content), skip_magic=True).records)
        if found.complete and _messages_outside(found.chunks, stream, footer.summary_start):
            found.complete = False
        return found
    except Exception:  # damaged numbers and texts raise almost anything
        return Summary(whole=True)


def _messages_outside(chunks: list[ChunkPlace], stream: BinaryIO, end: int) -> bool:
    """Return whether a message stands between chunks, where no index lists it."""
    begins = [len(MAGIC), *(chunk.next_record for chunk in chunks)]
    ends = [*(chunk.start for chunk in chunks), end]
    for place, gap_end in zip(begins, ends):
        while place < gap_end:
            stream.seek(place)
            opcode, length = RECORD_HEAD.unpack(stream.read(RECORD_HEAD.size))
            if opcode == Opcode.MESSAGE:
                return True
            place += RECORD_HEAD.size + length
    return False


def _collected(records: Iterable[McapRecord]) -> Summary:
    """Collect what is needed from the records of a summary."""
    found = Summary(whole=True)
    statistics = None
    known: dict[frozenset[int], frozenset[int]] = {}  # most chunks have the same channels
    for record in records:
        if isinstance(record, (Schema, Channel)):
            found.descriptions.append(record)
        elif isinstance(record, ChunkIndex):
            present = frozenset(record.message_index_offsets)
            start = record.chunk_start_offset
            end = start + record.chunk_length
            found.chunks.append(ChunkPlace(
                start, end, end + record.message_index_length, known.setdefault(present, present)))
        elif isinstance(record, MetadataIndex):
            found.metadata.append(Record(
                int(Opcode.METADATA), record.offset, record.offset + record.length))
        elif isinstance(record, Statistics):
            statistics = record
    found.chunks.sort()
    if statistics is not None:
        channels = {record.id for record in found.descriptions if isinstance(record, Channel)}
        counts = len(channels), len(found.chunks), len(found.metadata)
        found.complete = counts == (
            statistics.channel_count, statistics.chunk_count, statistics.metadata_count)
        if statistics.message_count:
            found.span_ns = statistics.message_start_time, statistics.message_end_time
    return found
