# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Messages of chunks, and the channels that say which messages are wanted."""

from dataclasses import replace
from io import BytesIO
from struct import Struct
from typing import Any, Mapping, NamedTuple

from mcap import exceptions, stream_reader
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Schema
from mcap.stream_reader import get_chunk_data_stream

from .source import canonical
from ..exceptions import MissingPackageError, RecordingError

_MESSAGE_HEAD = Struct('<BQH4xQ8x')  # opcode, length, channel, log time
_MESSAGE = int(Opcode.MESSAGE)
_ZSTANDARD = b'\x28\xb5\x2f\xfd'  # begins what rosbag2 compressed; CDR begins with zero
LARGEST_CHUNK = 1 << 28
"""Bytes of a decompressed chunk; recorders write some MB, and memory is bounded by one chunk."""
# Older versions of mcap without it cannot be imported unless both decompressors are installed.
_NoDecompressor: Any = getattr(exceptions, 'UnsupportedCompressionError', ())
_DESCRIPTIONS = {int(Opcode.SCHEMA): Schema, int(Opcode.CHANNEL): Channel}


class RecordedMessage(NamedTuple):
    """One message of a recording."""

    topic: str  # its topic, as requested
    log_time_ns: int  # when it was received [ns]
    data: bytes  # CDR with its encapsulation header


class Channels:
    """
    The channels of one file, as far as they are known.

    types: type of each topic found so far
    definitions: of each type found so far
    handed_out: the wanted channels and the topic to hand out for their messages
    """

    def __init__(self, wanted: Mapping[str, str] | None = None) -> None:
        self.types: dict[str, str] = {}
        self.handed_out: dict[int, str] = {}
        self._wanted = wanted
        self.definitions: dict[str, str] = {}
        self._schemas: dict[int, str] = {}

    def add(self, record: Schema | Channel | None) -> None:
        """Add a schema or channel; None (damaged) is ignored."""
        if isinstance(record, Schema):
            self._schemas[record.id] = record.name
            self.definitions[record.name] = record.data.decode(errors='replace')
        elif record is not None:
            self.types[record.topic] = self._schemas.get(record.schema_id, '')
            name = canonical(record.topic)
            if self._wanted is None:
                self.handed_out[record.id] = record.topic
            elif name in self._wanted:
                self.handed_out[record.id] = self._wanted[name]


class Walk(NamedTuple):
    """Result of walking over records."""

    messages: list[RecordedMessage]  # the wanted messages
    end: int  # place of the first record that was not walked over
    last: int  # place of the last record that was


def walk(data: bytes, channels: Channels) -> Walk:
    """
    Collect messages until the end or the first record of another kind or cut short.

    The package mcap builds an object for each message, which takes five times as long.

    """
    messages: list[RecordedMessage] = []
    append, make, message_type = messages.append, tuple.__new__, RecordedMessage
    unpack, topic_of = _MESSAGE_HEAD.unpack_from, channels.handed_out.get
    at, last, end = 0, 0, len(data)
    padded = data + bytes(_MESSAGE_HEAD.size)  # other records may be shorter than this head
    while at < end:
        opcode, length, channel, log_time_ns = unpack(padded, at)
        after = at + 9 + length
        if after > end:
            break
        if opcode == _MESSAGE:
            topic = topic_of(channel)
            if topic is not None:
                append(make(message_type, (topic, log_time_ns, data[at + 31:after])))
        elif opcode in _DESCRIPTIONS:
            channels.add(parsed(_DESCRIPTIONS[opcode], data[at + 9:after]))
        else:
            break
        last, at = at, after
    return Walk(messages, at, last)


def read_chunk(content: bytes, channels: Channels) -> list[RecordedMessage] | None:
    """Decompress a chunk and collect its messages."""
    chunk = parsed(Chunk, content)
    if chunk is None:
        return None
    try:
        stream, size = get_chunk_data_stream(_of_stated_size(chunk), validate_crc=True)
    except _NoDecompressor as error:
        raise MissingPackageError.of(
            chunk.compression, 'reading this compressed recording') from error
    except RecordingError:
        raise
    except Exception:  # each decompressor has its own exceptions for damaged data
        return None
    if size != chunk.uncompressed_size:
        return None
    result = walk(stream.read(size), channels)
    return result.messages if result.end == size or result.messages else None


def _of_stated_size(chunk: Chunk) -> Chunk:
    """Require that a chunk decompresses to no more than it states, before that takes memory."""
    size, data = chunk.uncompressed_size, chunk.data
    if chunk.compression == 'zstd' and stream_reader.zstandard:
        if stream_reader.zstandard.frame_content_size(data) not in (size, -1):
            raise ValueError('another size than stated')
    elif chunk.compression == 'lz4' and stream_reader.lz4:
        data = stream_reader.lz4.LZ4FrameDecompressor().decompress(
            data, min(size, LARGEST_CHUNK) + 1)
        size, chunk = len(data), replace(chunk, compression='', data=data)
    else:
        return chunk
    _require_size(size)
    return chunk


def decompressed(messages: list[RecordedMessage]) -> list[RecordedMessage]:
    """Decompress messages one by one: compression_mode MESSAGE of rosbag2."""
    if not messages or not messages[0].data.startswith(_ZSTANDARD):
        return messages
    if not stream_reader.zstandard:
        raise MissingPackageError.of('zstandard', 'reading this compressed recording')
    found, total, decompressor = [], 0, stream_reader.zstandard.ZstdDecompressor()
    for message in messages:
        if message.data.startswith(_ZSTANDARD):
            try:
                size = stream_reader.zstandard.frame_content_size(message.data)
                _require_size(total + size)
                data = decompressor.decompress(message.data) if size >= 0 else (
                    decompressor.stream_reader(message.data).read(LARGEST_CHUNK - total + 1))
            except stream_reader.zstandard.ZstdError:
                data = b''  # counted as malformed where it is decoded
            total += len(data)
            _require_size(total)
            message = message._replace(data=data)
        found.append(message)
    return found


def _require_size(size: int) -> None:
    if size > LARGEST_CHUNK:
        raise RecordingError(
            f'a chunk of the recording takes {size >> 20} MiB decompressed, '
            f'expected at most {LARGEST_CHUNK >> 20} MiB; write smaller chunks with: mcap '
            'compress --chunk-size 4194304')


def parsed(kind: Any, content: bytes) -> Any:
    """Parse the content of a record with the class of the package mcap; None if damaged."""
    try:
        return kind.read(ReadDataStream(BytesIO(content)))
    except Exception:  # damaged numbers and texts raise almost anything
        return None
