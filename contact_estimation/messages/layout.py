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
Reading and writing the numbers of CDR messages that share one structure.

All bytes that hold no number are structure (texts, sequence lengths): messages that agree in them
have their numbers at the same places, because every length and text that comes before a number
decides where it is.

"""

from __future__ import annotations

import operator
import struct
from typing import Any, Sequence

import numpy as np

from .locating import Slot

_NUMPY_KIND = {'d': 'f8', 'i': 'i4', 'I': 'u4'}
_NAN_TAIL = (float('nan'),)


class ReadingLayout:
    """
    Reads some numbers of all messages that share one structure.

    Parameters
    ----------
    reference : bytes
        A message with this structure.
    slots : sequence of Slot
        All its numbers; they may change from message to message.
    wanted : sequence of int or None
        Which of `slots` to read, in this order; None reads NaN.
    ignored : collection of int
        Offsets of bytes without meaning, such as alignment padding, in which some libraries
        leave garbage.

    """

    def __init__(
        self,
        reference: bytes,
        slots: Sequence[Slot],
        wanted: Sequence[int | None],
        ignored: frozenset[int] = frozenset(),
    ) -> None:
        self.size = len(reference)
        self.ignored = ignored
        self._reference = reference
        numeric = {at for slot in slots for at in range(slot.offset, slot.end)}
        self._structural = frozenset(range(self.size)) - numeric - ignored
        chosen = {slots[index] for index in wanted if index is not None}
        skipped = set(ignored).union(*(range(s.offset, s.end) for s in set(slots) - chosen))
        parts = _partition(self.size, chosen, skipped)
        self._unpack = struct.Struct('<' + ''.join(code for _, code in parts if code)).unpack
        kept = [part for part in parts if not part[1].endswith('x')]
        places = {offset: place for place, (offset, _) in enumerate(kept)}
        structural = [place for place, (_, code) in enumerate(kept) if code.endswith('s')]
        self._structure = operator.itemgetter(*structural)
        self._expected = self._structure(self._unpack(reference))
        self._table = np.dtype({
            'names': [str(offset) for offset, code in kept if not code.endswith('s')],
            'formats': ['<' + _NUMPY_KIND[code] for _, code in kept if not code.endswith('s')],
            'offsets': [offset for offset, code in kept if not code.endswith('s')],
            'itemsize': self.size,
        })
        self._columns = [None if i is None else str(slots[i].offset) for i in wanted]
        places_of_structure = np.array(sorted(self._structural), dtype=np.intp)
        self._structural_places = places_of_structure
        self._structural_bytes = np.frombuffer(reference, np.uint8)[places_of_structure]
        # NaN is appended to what is unpacked, so that an absent number costs no branch.
        nan_place = len(kept)
        self._numbers = operator.itemgetter(
            *(nan_place if i is None else places[slots[i].offset] for i in wanted)
        )

    def read(self, raw: bytes) -> tuple[Any, ...] | None:
        """
        Read the wanted numbers.

        Parameters
        ----------
        raw : bytes
            A serialised message.

        Returns
        -------
        numbers : tuple or None
            None if the message has another structure.

        """
        if len(raw) != self.size:
            return None
        values = self._unpack(raw)
        if self._structure(values) != self._expected:
            return None
        return self._numbers(values + _NAN_TAIL)

    def read_many(self, raws: Sequence[bytes]) -> tuple[Any, ...] | None:
        """
        Read the wanted numbers of many messages at once.

        Parameters
        ----------
        raws : sequence of bytes
            Serialised messages, at least one.

        Returns
        -------
        columns : tuple of ndarray, shape (N,), or None
            None if a message has another structure.

        """
        if set(map(len, raws)) != {self.size}:
            return None
        joined = b''.join(raws)
        octets = np.frombuffer(joined, np.uint8).reshape(len(raws), self.size)
        if (octets[:, self._structural_places] != self._structural_bytes).any():
            return None
        table = np.frombuffer(joined, self._table)
        absent = np.full(len(raws), np.nan)
        return tuple(absent if name is None else table[name] for name in self._columns)

    def structural_difference(self, raw: bytes) -> frozenset[int]:
        """List the offsets at which a message of the same length differs in structure."""
        reference = self._reference
        return frozenset(at for at in self._structural if raw[at] != reference[at])


class WritingLayout:
    """
    Writes messages that differ in some numbers only.

    Parameters
    ----------
    template : bytes
        A message serialised by the library.
    slots : sequence of Slot
        The numbers to write.

    """

    def __init__(self, template: bytes, slots: Sequence[Slot]) -> None:
        parts = _partition(len(template), set(slots), set())
        self._pack = struct.Struct('<' + ''.join(code for _, code in parts)).pack
        constant = [(offset, code) for offset, code in parts if code.endswith('s')]
        self._constant = tuple(template[at:at + int(code[:-1])] for at, code in constant)
        order = {slot.offset: place for place, slot in enumerate(slots)}
        for place, (offset, _) in enumerate(constant):
            order[offset] = len(slots) + place
        self._arrange = operator.itemgetter(*(order[offset] for offset, _ in parts))

    def write(self, *numbers: float) -> bytes:
        """Return the message with these numbers, in the order of the slots."""
        return self._pack(*self._arrange(numbers + self._constant))


def _partition(size: int, numbers: set[Slot], skipped: set[int]) -> list[tuple[int, str]]:
    """Divide a message into struct codes: numbers, 's' for structure, 'x' for skipped bytes."""
    at_offset = {slot.offset: slot for slot in numbers}
    parts: list[tuple[int, str]] = []
    offset = 0
    while offset < size:
        slot = at_offset.get(offset)
        if slot is not None:
            parts.append((offset, slot.kind))
            offset = slot.end
            continue
        start, skip = offset, offset in skipped
        while offset < size and offset not in at_offset and (offset in skipped) == skip:
            offset += 1
        parts.append((start, f'{offset - start}' + ('x' if skip else 's')))
    return parts
