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

"""The summary at the end of an MCAP file, and what stands in for it where there is none."""

from __future__ import annotations

import dataclasses
from typing import BinaryIO
import zlib

from .chunk_reader import Channels
from .mcap_format import (
    CHANNEL,
    ContentReader,
    FOOTER,
    MAGIC,
    METADATA,
    METADATA_INDEX,
    RECORD_HEAD,
    SCHEMA,
    STATISTICS,
)
from .record_scanner import RecordScanner

_FOOTER_CONTENT = 20
_TAIL = RECORD_HEAD.size + _FOOTER_CONTENT + len(MAGIC)
_LARGEST_METADATA = 1 << 26


@dataclasses.dataclass
class Summary:
    """
    What is known about a file without reading its messages.

    Attributes
    ----------
    whole : bool
        The file ends as it should; False where its recorder was killed.
    lists_topics : bool
        All topics are in `records`.
    lists_metadata : bool
        All metadata records are in `metadata_at`.
    records : list of tuple
        Opcode and content of the schemas and channels.
    metadata_at : list of tuple
        Place and length of the metadata records' content in the file.
    start_ns, end_ns : int or None
        Log times of the first and the last message [ns].

    """

    whole: bool = False
    lists_topics: bool = False
    lists_metadata: bool = False
    records: list[tuple[int, bytes]] = dataclasses.field(default_factory=list)
    metadata_at: list[tuple[int, int]] = dataclasses.field(default_factory=list)
    start_ns: int | None = None
    end_ns: int | None = None

    def teach(self, channels: Channels) -> None:
        """Hand the schemas and channels on, so that damage to their chunk does no harm."""
        for opcode, content in self.records:
            channels.learn(opcode, content)


def read_summary(stream: BinaryIO, size: int) -> Summary:
    """
    Read the summary of a file.

    Parameters
    ----------
    stream : binary file
        The file.
    size : int
        Its size.

    Returns
    -------
    summary : Summary
        Empty where the file has none or it is damaged.

    """
    stream.seek(max(size - _TAIL, 0))
    tail = stream.read(_TAIL)
    if len(tail) < _TAIL or tail[-len(MAGIC):] != MAGIC:
        return Summary()
    if RECORD_HEAD.unpack_from(tail) != (FOOTER, _FOOTER_CONTENT):
        return Summary()
    fields = ContentReader(tail[RECORD_HEAD.size:])
    start, _, crc = fields.number(8), fields.number(8), fields.number(4)
    if not len(MAGIC) <= start <= size - _TAIL:
        return Summary(whole=True)
    stream.seek(start)
    content = stream.read(size - _TAIL - start)
    # The CRC covers the summary and the footer up to the CRC itself.
    if crc and zlib.crc32(content + tail[:RECORD_HEAD.size + 16]) != crc:
        return Summary(whole=True)
    try:
        return _parse(content)
    except ValueError:
        return Summary(whole=True)


def survey(scanner: RecordScanner) -> Summary:
    """
    Find metadata records and the time span of a file without summary, passing over the messages.

    Parameters
    ----------
    scanner : RecordScanner
        At the start of the file.

    Returns
    -------
    summary : Summary
        Without topics: these may stand within chunks.

    """
    found = Summary(lists_metadata=True)
    spans = []
    while (record := scanner.advance()) is not None:
        if record.chunk is not None:
            scanner.confirm()
            spans.append((record.chunk.start_ns, record.chunk.end_ns))
        elif record.opcode == METADATA and record.length <= _LARGEST_METADATA:
            found.metadata_at.append((record.content, record.length))
    if spans:
        found.start_ns = min(start for start, _ in spans)
        found.end_ns = max(end for _, end in spans)
    return found


def _parse(content: bytes) -> Summary:
    """Take what is needed from the records of a summary; ValueError if they are damaged."""
    found = Summary(whole=True)
    channel_count = metadata_count = None
    at = 0
    while at + RECORD_HEAD.size <= len(content):
        opcode, length = RECORD_HEAD.unpack_from(content, at)
        at += RECORD_HEAD.size
        record = content[at:at + length]
        at += length
        fields = ContentReader(record)
        if opcode in (SCHEMA, CHANNEL):
            found.records.append((opcode, record))
        elif opcode == METADATA_INDEX:
            place, whole_length = fields.number(8), fields.number(8)
            found.metadata_at.append(
                (place + RECORD_HEAD.size, whole_length - RECORD_HEAD.size)
            )
        elif opcode == STATISTICS:
            messages, _, channel_count = fields.number(8), fields.number(2), fields.number(4)
            _, metadata_count, _ = fields.number(4), fields.number(4), fields.number(4)
            times = fields.number(8), fields.number(8)
            found.start_ns, found.end_ns = times if messages else (None, None)
    listed = {record[:2] for opcode, record in found.records if opcode == CHANNEL}
    found.lists_topics = len(listed) == channel_count
    found.lists_metadata = len(found.metadata_at) == metadata_count
    return found
