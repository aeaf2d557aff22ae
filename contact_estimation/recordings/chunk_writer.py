# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""An MCAP file that is written chunk by chunk, each handed to the operating system when full."""

from __future__ import annotations

from typing import BinaryIO, Callable

from mcap.writer import CompressionType, Writer

CHUNK_BYTES = 64 * 1024
CHUNK_SPAN_NS = 500_000_000

_MESSAGE_RECORD_BYTES = 31  # opcode, length, channel, sequence and two times
_OTHER_RECORD_BYTES = 128  # at least what a schema or channel record adds to its texts


class ChunkWriter:
    """
    Write messages in chunks that are small in bytes and short in time.

    SIGKILL destroys only the chunk in progress: at most 0.5 s of log time.

    """

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._writer = Writer(
            stream, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD
        )
        self._finish_chunk = _chunk_finisher(self._writer)
        self._schemas: dict[str, int] = {}
        self._bytes = 0
        self._start_ns: int | None = None
        self._writer.start(profile='ros2', library='contact_estimation')
        stream.flush()

    def add_topic(
        self, topic: str, type_name: str, definition: str, metadata: dict[str, str]
    ) -> int:
        """Register a topic whose messages are CDR; return its channel."""
        schema = self._schemas.get(type_name)
        if schema is None:
            schema = self._writer.register_schema(type_name, 'ros2msg', definition.encode())
            self._schemas[type_name] = schema
        self._bytes += len(definition) + sum(map(len, metadata.values())) + _OTHER_RECORD_BYTES
        return self._writer.register_channel(topic, 'cdr', schema, metadata)

    def add_message(
        self, channel: int, log_time_ns: int, publish_time_ns: int, data: bytes
    ) -> None:
        """Write a message and finish the chunk if it is full or long enough."""
        self._writer.add_message(channel, log_time_ns, data, publish_time_ns)
        self._bytes += len(data) + _MESSAGE_RECORD_BYTES
        if self._start_ns is None:
            self._start_ns = log_time_ns
        # Absolute value: the clock of a simulation jumps back when the simulation restarts.
        span = abs(log_time_ns - self._start_ns)
        if self._bytes > CHUNK_BYTES or span >= CHUNK_SPAN_NS:
            self.flush()

    def add_metadata(self, name: str, values: dict[str, str]) -> None:
        """Write a metadata record."""
        self._writer.add_metadata(name, values)
        self._stream.flush()

    def flush(self) -> None:
        """Finish the chunk in progress and hand it to the operating system."""
        if self._start_ns is None:
            return
        self._finish_chunk()
        self._stream.flush()
        self._bytes = 0
        self._start_ns = None

    def close(self) -> None:
        """Write the summary and close the file."""
        self._writer.finish()
        self._stream.close()


def _chunk_finisher(writer: Writer) -> Callable[[], None]:
    """
    Find how to end a chunk early.

    Older versions of the package mcap have a private method instead of `Writer.flush`. Without
    either, chunks end at 64 KiB, and a kill at a low message rate loses more than 0.5 s.

    """
    public = getattr(writer, 'flush', None)
    if public is not None:
        return public
    return getattr(writer, '_Writer__finalize_chunk', _nothing)


def _nothing() -> None:
    """Leave ending chunks to the writer."""
