# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The summary of an MCAP file: topics, time span, and where chunks and metadata are."""

from __future__ import annotations

from dataclasses import dataclass, field
from io import BytesIO
from typing import BinaryIO, Iterable, NamedTuple
import zlib

from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    ChunkIndex,
    Footer,
    McapRecord,
    MetadataIndex,
    Schema,
    Statistics,
)
from mcap.stream_reader import StreamReader

from .chunk_reader import parsed
from .record_scanner import MAGIC, Record, RECORD_HEAD

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
                start, end, end + record.message_index_length, known.setdefault(present, present)
            ))
        elif isinstance(record, MetadataIndex):
            found.metadata.append(Record(
                int(Opcode.METADATA), record.offset, record.offset + record.length
            ))
        elif isinstance(record, Statistics):
            statistics = record
    found.chunks.sort()
    if statistics is not None:
        channels = {record.id for record in found.descriptions if isinstance(record, Channel)}
        counts = len(channels), len(found.chunks), len(found.metadata)
        found.complete = counts == (
            statistics.channel_count, statistics.chunk_count, statistics.metadata_count
        )
        if statistics.message_count:
            found.span_ns = statistics.message_start_time, statistics.message_end_time
    return found
