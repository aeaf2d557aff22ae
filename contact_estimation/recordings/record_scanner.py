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

"""Top-level records of an MCAP file one after the other, across damage and up to a cut."""

from __future__ import annotations

import re
from typing import BinaryIO, NamedTuple

from .mcap_format import (
    CHUNK,
    ChunkHead,
    DATA_END,
    FOOTER,
    MAGIC,
    parse_chunk_head,
    RECORD_HEAD,
    SHORTEST,
)

_WINDOW = 1 << 20
_FIRST_PRIVATE_OPCODE = 0x80
# An opcode and a length below 4 GiB; looking ahead, because candidates may overlap.
_CANDIDATE = re.compile(rb'(?s)(?=[\x02-\x0f].{4}\x00{4})')
_FIXED = {FOOTER: 20, DATA_END: 4}
# Enough for the description of any chunk with a known compression.
_HEAD_BYTES = 64


class Record(NamedTuple):
    """
    Place of a top-level record.

    Attributes
    ----------
    opcode : int
        Its kind.
    start : int
        Place of its opcode in the file.
    length : int
        Bytes of its content.
    chunk : ChunkHead or None
        Description of the chunk where it is one.

    """

    opcode: int
    start: int
    length: int
    chunk: ChunkHead | None = None

    @property
    def content(self) -> int:
        """Place of the content in the file."""
        return self.start + RECORD_HEAD.size

    @property
    def end(self) -> int:
        """Place of the next record."""
        return self.content + self.length


class RecordScanner:
    """
    Walks over the records of a file; where one makes no sense, searches the next that does.

    Parameters
    ----------
    stream : binary file
        The file, which may be moved between calls.
    size : int
        Its size when it was opened; a recorder may still be writing.

    Attributes
    ----------
    position : int
        Where the next record is expected.
    damaged : int
        How often something had to be skipped.

    """

    def __init__(self, stream: BinaryIO, size: int) -> None:
        self.position = len(MAGIC)
        self.damaged = 0
        self._stream = stream
        self._size = size
        self._resume = self.position
        self._counted = False

    def advance(self) -> Record | None:
        """
        Find the next record.

        Returns
        -------
        record : Record or None
            None at the end of the data, or where the file is cut.

        """
        record = self._record_at(self.position)
        if record is None or not self._credible(record):
            if self._is_cut_chunk():
                return None
            record = self._search()
            if record is None:
                return None
            self.damaged += not self._counted
        self._counted = False
        self.move(record.end, record.start)
        return None if record.opcode in (DATA_END, FOOTER) else record

    def move(self, position: int, last: int) -> None:
        """Go on at `position`; should that fail, search from just after `last`."""
        self.position = position
        self._resume = last + 1

    def confirm(self) -> None:
        """Take note that the last record was whole, so that nothing is searched within it."""
        self._resume = self.position

    def reject(self) -> None:
        """Count the last record as damaged."""
        self.damaged += 1
        self._counted = True

    def read(self, start: int, size: int) -> bytes:
        """Read some bytes of the file, fewer at its end."""
        self._stream.seek(start)
        return self._stream.read(min(size, max(self._size - start, 0)))

    def _record_at(self, start: int) -> Record | None:
        """Read the head of a record and check what can be checked."""
        head = self.read(start, RECORD_HEAD.size)
        if len(head) < RECORD_HEAD.size:
            return None
        opcode, length = RECORD_HEAD.unpack(head)
        record = Record(opcode, start, length)
        if record.end > self._size or length < SHORTEST.get(opcode, 0):
            return None
        if length != _FIXED.get(opcode, length):
            return None
        if opcode != CHUNK:
            return record
        chunk = parse_chunk_head(self.read(record.content, min(length, _HEAD_BYTES)), length)
        return None if chunk is None else record._replace(chunk=chunk)

    def _credible(self, record: Record) -> bool:
        """Tell whether a record may stand here; unknown ones must be followed by a known one."""
        if record.opcode in SHORTEST:
            return True
        following = self._record_at(record.end)
        known = following is not None and following.opcode in SHORTEST
        return record.opcode >= _FIRST_PRIVATE_OPCODE and known

    def _is_cut_chunk(self) -> bool:
        """Tell whether a good chunk reaches beyond the end: killed while writing it."""
        head = self.read(self.position, RECORD_HEAD.size + _HEAD_BYTES)
        if len(head) < RECORD_HEAD.size or head[0] != CHUNK:
            return False
        length = RECORD_HEAD.unpack_from(head)[1]
        return parse_chunk_head(head[RECORD_HEAD.size:], length) is not None

    def _search(self) -> Record | None:
        """Find the next place from which on the records make sense."""
        start = self._resume
        while start < self._size:
            window = self.read(start, _WINDOW + RECORD_HEAD.size)
            for candidate in _CANDIDATE.finditer(window):
                record = self._record_at(start + candidate.start())
                if record is not None and self._is_followed(record):
                    return record
            start += _WINDOW
        return None

    def _is_followed(self, record: Record) -> bool:
        """Check the next two records, or that the file ends there."""
        if record.chunk is not None:
            return True  # its lengths agree, which no accident brings about
        end = record.end
        for _ in range(2):
            if end in (self._size, self._size - len(MAGIC)):
                return True
            following = self._record_at(end)
            if following is None or following.opcode not in SHORTEST:
                return False
            end = following.end
        return True
