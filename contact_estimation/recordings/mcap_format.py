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

"""The parts of the MCAP format that reading needs; see https://mcap.dev/spec."""

from __future__ import annotations

import struct
from typing import NamedTuple

MAGIC = b'\x89MCAP0\r\n'

HEADER = 0x01
FOOTER = 0x02
SCHEMA = 0x03
CHANNEL = 0x04
MESSAGE = 0x05
CHUNK = 0x06
CHUNK_INDEX = 0x08
STATISTICS = 0x0B
METADATA = 0x0C
METADATA_INDEX = 0x0D
DATA_END = 0x0F

RECORD_HEAD = struct.Struct('<BQ')
MESSAGE_HEAD = struct.Struct('<BQH4xQ8x')  # opcode, length, channel, log time
CHUNK_HEAD = struct.Struct('<QQQII')  # start, end, size, CRC, length of the compression's name

# The shortest content of each record; what is shorter is damaged.
SHORTEST = {
    HEADER: 8, FOOTER: 20, SCHEMA: 14, CHANNEL: 16, MESSAGE: 22, CHUNK: 40, 0x07: 6,
    CHUNK_INDEX: 64, 0x09: 36, 0x0A: 48, STATISTICS: 46, METADATA: 8, METADATA_INDEX: 20,
    0x0E: 17, DATA_END: 4,
}


class ChunkHead(NamedTuple):
    """
    The description of a chunk before its data.

    Attributes
    ----------
    start_ns, end_ns : int
        Log time of the first and the last message [ns].
    size : int
        Bytes after decompression.
    crc : int
        CRC-32 after decompression; 0 where none was computed.
    compression : str
        '', 'zstd' or 'lz4'.
    data_offset : int
        Place of the data in the record's content.

    """

    start_ns: int
    end_ns: int
    size: int
    crc: int
    compression: str
    data_offset: int


def parse_chunk_head(content: bytes, length: int) -> ChunkHead | None:
    """
    Read the description of a chunk and check it against the record's length.

    Parameters
    ----------
    content : bytes
        The record's content, at least its first 64 bytes.
    length : int
        Length of the whole content.

    Returns
    -------
    head : ChunkHead or None
        None where the numbers contradict each other, so that this is no chunk.

    """
    if len(content) < SHORTEST[CHUNK]:
        return None
    start_ns, end_ns, size, crc, name_length = CHUNK_HEAD.unpack_from(content)
    name_end = CHUNK_HEAD.size + name_length
    if name_length > 16 or len(content) < name_end + 8:
        return None
    data_length = int.from_bytes(content[name_end:name_end + 8], 'little')
    if name_end + 8 + data_length != length:
        return None
    name = content[CHUNK_HEAD.size:name_end].decode('ascii', 'replace')
    return ChunkHead(start_ns, end_ns, size, crc, name, name_end + 8)


class ContentReader:
    """
    Reads the fields of one record in order.

    Parameters
    ----------
    content : bytes
        The record's content.

    """

    def __init__(self, content: bytes) -> None:
        self._content = content
        self._at = 0

    def number(self, size: int) -> int:
        """Read an unsigned integer; ValueError if the content ends before it."""
        return int.from_bytes(self._take(size), 'little')

    def text(self) -> str:
        """Read a text with its length before it; ValueError if it is cut or no UTF-8."""
        return self._take(self.number(4)).decode()

    def texts(self) -> dict[str, str]:
        """Read a map of texts with its size before it; ValueError if it is cut."""
        end = self.number(4) + self._at
        found = {}
        while self._at < end:
            key = self.text()
            found[key] = self.text()
        return found

    def _take(self, size: int) -> bytes:
        """Read some bytes."""
        taken = self._content[self._at:self._at + size]
        if len(taken) < size:
            raise ValueError('record is cut short')
        self._at += size
        return taken
