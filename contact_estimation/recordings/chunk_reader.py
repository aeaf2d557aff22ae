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

"""Messages out of decompressed chunks, and the channels that say which messages are wanted."""

from __future__ import annotations

from typing import Mapping, NamedTuple
import zlib

from .decompression import decompress
from .mcap_format import (
    CHANNEL,
    ChunkHead,
    ContentReader,
    MESSAGE,
    MESSAGE_HEAD,
    RECORD_HEAD,
    SCHEMA,
)
from .topic_names import canonical


class RecordedMessage(NamedTuple):
    """
    One message of a recording.

    Attributes
    ----------
    topic : str
        Its topic, as it was asked for.
    log_time_ns : int
        When it was received [ns].
    data : bytes
        CDR with its encapsulation header.

    """

    topic: str
    log_time_ns: int
    data: bytes


class Channels:
    """
    The channels of one file, as far as they are known.

    Parameters
    ----------
    wanted : mapping of str to str, optional
        Canonical names of the topics to read and the names to hand out for them; all by default.

    Attributes
    ----------
    types : dict of str to str
        Type of each topic found so far.
    handed_out : dict of int to str
        The wanted channels and the topic to hand out for their messages.

    """

    def __init__(self, wanted: Mapping[str, str] | None = None) -> None:
        self.types: dict[str, str] = {}
        self.handed_out: dict[int, str] = {}
        self._wanted = wanted
        self._schemas: dict[int, str] = {}

    def learn(self, opcode: int, content: bytes) -> None:
        """Take note of a schema or channel record; a damaged one is passed over."""
        fields = ContentReader(content)
        try:
            number = fields.number(2)
            if opcode == SCHEMA:
                self._schemas[number] = fields.text()
                return
            schema, topic = fields.number(2), fields.text()
        except ValueError:
            return
        self.types[topic] = self._schemas.get(schema, '')
        if self._wanted is None:
            self.handed_out[number] = topic
        elif canonical(topic) in self._wanted:
            self.handed_out[number] = self._wanted[canonical(topic)]


class Walk(NamedTuple):
    """
    Result of walking over records.

    Attributes
    ----------
    messages : list of RecordedMessage
        The wanted messages.
    end : int
        Place of the first record that was not walked over.
    last : int
        Place of the last record that was.

    """

    messages: list[RecordedMessage]
    end: int
    last: int


def walk(data: bytes, channels: Channels) -> Walk:
    """
    Collect messages until the end or the first record of another kind or cut short.

    Parameters
    ----------
    data : bytes
        Records one after the other.
    channels : Channels
        What is wanted; learns the channels on the way.

    Returns
    -------
    result : Walk
        The messages and how far it went.

    """
    # This loop takes most of the time of reading an hour: hence no calls that can be avoided.
    messages: list[RecordedMessage] = []
    append, make, message_type = messages.append, tuple.__new__, RecordedMessage
    unpack, topic_of = MESSAGE_HEAD.unpack_from, channels.handed_out.get
    at, last, end, last_head = 0, 0, len(data), len(data) - MESSAGE_HEAD.size
    while at <= last_head:
        opcode, length, channel, log_time_ns = unpack(data, at)
        after = at + 9 + length
        if after > end:
            break
        if opcode == MESSAGE:
            topic = topic_of(channel)
            if topic is not None:
                append(make(message_type, (topic, log_time_ns, data[at + 31:after])))
        elif opcode in (SCHEMA, CHANNEL):
            channels.learn(opcode, data[at + 9:after])
        else:
            break
        last, at = at, after
    return Walk(messages, *_walk_short(data, at, last, channels))


def read_chunk(content: bytes, head: ChunkHead, channels: Channels) -> Walk | None:
    """
    Decompress a chunk and collect its messages.

    Parameters
    ----------
    content : bytes
        The chunk record's content.
    head : ChunkHead
        Its description.
    channels : Channels
        What is wanted; learns the channels in the chunk.

    Returns
    -------
    result : Walk or None
        None if the chunk is damaged.

    """
    data = decompress(content[head.data_offset:], head)
    if data is None or len(data) != head.size:
        return None
    if head.crc and zlib.crc32(data) != head.crc:
        return None
    result = walk(data, channels)
    return result if result.end == len(data) or result.messages else None


def _walk_short(data: bytes, at: int, last: int, channels: Channels) -> tuple[int, int]:
    """Walk over schemas and channels at the end that are shorter than a message's head."""
    while at + RECORD_HEAD.size <= len(data):
        opcode, length = RECORD_HEAD.unpack_from(data, at)
        after = at + RECORD_HEAD.size + length
        if opcode not in (SCHEMA, CHANNEL) or after > len(data):
            break
        channels.learn(opcode, data[at + RECORD_HEAD.size:after])
        last, at = at, after
    return at, last
