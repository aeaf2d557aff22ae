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

"""
Where the numbers of a CDR message are, learned from the message library, not written by hand.

A message is serialised twice with different marker values in its numbers: a number sits where
the first serialisation holds its first marker and the second its second one.

"""

from __future__ import annotations

import struct
from typing import Any, NamedTuple, Sequence

from .codec import Codec
from .fields import Field, FLOAT64, INT32, set_values, UINT32

_SIZES = {INT32: 4, UINT32: 4, FLOAT64: 8}
# Valid as seconds and as nanoseconds; the number of the field is added.
_FIRST_MARKER = 0x2A5C3B00
_SECOND_MARKER = 0x1563D900


class Slot(NamedTuple):
    """Place of one number in the bytes of a message."""

    offset: int
    kind: str

    @property
    def end(self) -> int:
        """Offset of the first byte after the number."""
        return self.offset + _SIZES[self.kind]


class MarkedBytes(NamedTuple):
    """
    The bytes of a message with markers in its numbers, and where they were found.

    Attributes
    ----------
    data : bytes
        Serialisation with the first set of markers.
    slots : tuple of Slot
        Place of each field.

    """

    data: bytes
    slots: tuple[Slot, ...]


def locate(
    codec: Codec, message: Any, type_name: str, fields: Sequence[Field]
) -> MarkedBytes | None:
    """
    Find where the library puts the numbers of a message.

    Parameters
    ----------
    codec : Codec
        The library.
    message : object
        Its numbers are overwritten with markers.
    type_name : str
        Type of the message.
    fields : sequence of Field
        All numbers to locate.

    Returns
    -------
    marked : MarkedBytes or None
        None where a number cannot be located beyond doubt.

    """
    first = _mark(codec, message, type_name, fields, _FIRST_MARKER)
    second = _mark(codec, message, type_name, fields, _SECOND_MARKER)
    slots = []
    for number, field in enumerate(fields):
        one = struct.pack('<' + field.kind, _marker(field.kind, _FIRST_MARKER + number))
        two = struct.pack('<' + field.kind, _marker(field.kind, _SECOND_MARKER + number))
        found = [at for at in _occurrences(first, one) if second.startswith(two, at)]
        if len(found) != 1:
            return None
        slots.append(Slot(found[0], field.kind))
    return MarkedBytes(first, tuple(slots))


def _mark(
    codec: Codec, message: Any, type_name: str, fields: Sequence[Field], base: int
) -> bytes:
    """Serialise the message with markers in its numbers."""
    markers = [_marker(field.kind, base + number) for number, field in enumerate(fields)]
    set_values(message, fields, markers, codec)
    return codec.serialize(message, type_name)


def _marker(kind: str, code: int) -> Any:
    """Make a value whose bytes are unmistakable and differ from those of every other code."""
    if kind in (INT32, UINT32):
        return code
    return struct.unpack('<d', struct.pack('<II', code, code ^ 0x6B000000))[0]


def _occurrences(data: bytes, pattern: bytes) -> list[int]:
    """List all offsets of a pattern."""
    found = []
    at = data.find(pattern)
    while at >= 0:
        found.append(at)
        at = data.find(pattern, at + 1)
    return found
