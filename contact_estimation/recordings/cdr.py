# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
CDR: the layout of a serialised message, found once and reused for messages of the same structure.

Plain CDR (OMG DDS-XTypes 7.4.1, XCDR1): 4 bytes of encapsulation, then the fields in order. A
number of n bytes is aligned to n bytes, counted from the end of the encapsulation. A text is its
length (uint32, terminating NUL included) and its bytes; a sequence is its length and its elements.
Alignment bytes have no meaning and may hold anything.

"""

from operator import itemgetter
import struct
from typing import Any, Callable, Sequence, TypeVar

import numpy as np

from ..exceptions import MessageError

NS_PER_S = 1_000_000_000

_ENCAPSULATION = 4  # bytes
_STAMP = ((4, 'i'), (8, 'I'))  # seconds and nanoseconds of the header, the first field
# rmw_fastrtps sizes its buffers for the worst alignment and sends them whole.
_MOST_TRAILING_BYTES = 64
_MOST_LAYOUTS = 16
_NAN = float('nan')

Content = TypeVar('Content')


class CdrCursor:
    """
    Walk over the fields of one message.

    byte_order: '<' or '>', as in the struct module
    fixed: begin and end of the bytes passed so far on which the places of later fields depend:
    encapsulation, texts and lengths
    """

    def __init__(self, raw: bytes) -> None:
        if len(raw) < _ENCAPSULATION or raw[0] != 0 or raw[1] > 1:
            raise ValueError(
                f'expected plain CDR, which begins with 00 00 or 00 01, got {raw[:2].hex(" ")!r}')
        self.raw = raw
        self.byte_order = '<' if raw[1] else '>'
        self.fixed = [(0, 2)]
        self._at = _ENCAPSULATION

    def skip(self, size: int, alignment: int = 1) -> int:
        """Pass over some bytes; return where they begin."""
        begin = self._at + (_ENCAPSULATION - self._at) % alignment
        self._at = begin + size
        if self._at > len(self.raw):
            raise ValueError(f'it ends in a field that needs {self._at} bytes')
        return begin

    def length(self) -> int:
        """Read the length of a text or sequence."""
        begin = self.skip(4, 4)
        self._fix(begin)
        return int(struct.unpack_from(self.byte_order + 'I', self.raw, begin)[0])

    def text(self) -> str:
        """Read a text; an invalid one raises ValueError, too."""
        begin = self.skip(self.length())
        self._fix(begin)
        return self.raw[begin:max(begin, self._at - 1)].decode()

    def texts(self) -> list[str]:
        """Read a sequence of texts."""
        return [self.text() for _ in range(self.length())]

    def doubles(self, count: int | None = None) -> range:
        """Pass over `count` float64, or over a sequence of them; return where each begins."""
        size = 8 * (self.length() if count is None else count)
        begin = self.skip(size, 8) if size else self._at
        return range(begin, begin + size, 8)

    def finish(self) -> None:
        """Check that only padding follows."""
        if len(self.raw) - self._at > _MOST_TRAILING_BYTES:
            raise ValueError(f'{len(self.raw) - self._at} bytes follow its last field')

    def _fix(self, begin: int) -> None:
        """Note the bytes from `begin` on as fixed, joined with those right before them."""
        if self.fixed[-1][1] == begin:
            begin = self.fixed.pop()[0]
        self.fixed.append((begin, self._at))


class Layout:
    """Places of the numbers in all messages that agree in size and fixed bytes."""

    def __init__(self, cursor: CdrCursor, wanted: Sequence[tuple[int, str]]) -> None:
        self._size = len(cursor.raw)
        fixed = [(begin, f'{end - begin}s') for begin, end in cursor.fixed]
        fields = sorted([*wanted, *fixed])
        text, at = cursor.byte_order, 0
        for offset, code in fields:
            text += f'{offset - at}x{code}'
            at = offset + struct.calcsize('<' + code)
        self._unpack = struct.Struct(f'{text}{self._size - at}x').unpack
        self._fixed = itemgetter(*(fields.index(field) for field in fixed))
        self._expected = self._fixed(self._unpack(cursor.raw))
        self._place = {offset: number for number, (offset, _) in enumerate(fields)}


class StampedLayout(Layout):
    """Of messages that begin with a header."""

    def __init__(self, cursor: CdrCursor, frame_id: str, offsets: Sequence[int | None]) -> None:
        wanted = [(offset, 'd') for offset in {o for o in offsets if o is not None}]
        super().__init__(cursor, [*_STAMP, *wanted])
        self._offsets = offsets
        # Frame and NaN are appended to what is unpacked, so that they cost no branch.
        self._constants, end = (frame_id, _NAN), len(self._place)
        self._values = itemgetter(self._place[4], self._place[8], end, *(
            end + 1 if offset is None else self._place[offset] for offset in offsets))
        self._table = np.dtype({
            'names': ['sec', 'nanosec', *(str(offset) for offset, _ in wanted)],
            'formats': [cursor.byte_order + code for code in ('i4', 'u4', *['f8'] * len(wanted))],
            'offsets': [4, 8, *(offset for offset, _ in wanted)], 'itemsize': self._size,
        })
        self._reference = np.frombuffer(cursor.raw, np.uint8)
        self._mask = np.zeros(self._size, np.uint8)
        for begin, end in cursor.fixed:
            self._mask[begin:end] = 0xFF

    def read(self, raw: bytes) -> tuple[Any, ...] | None:
        """Read one message of the layout's size."""
        values = self._unpack(raw)
        if self._fixed(values) != self._expected:
            return None
        return self._values(values + self._constants)

    def read_many(self, raws: Sequence[bytes]) -> tuple[Any, ...] | None:
        """
        Read many messages at once.

        Returns columns (N,): stamps [ns] and the wanted numbers; None if the layout does not fit
        all messages
        """
        if set(map(len, raws)) != {self._size}:
            return None
        joined = b''.join(raws)
        octets = np.frombuffer(joined, np.uint8).reshape(len(raws), self._size)
        if ((octets ^ self._reference) & self._mask).any():
            return None
        table = np.frombuffer(joined, self._table)
        stamps_ns = table['sec'].astype(np.int64) * NS_PER_S + table['nanosec']
        absent = np.full(len(raws), np.nan)
        columns = [absent if o is None else table[str(o)] for o in self._offsets]
        return (stamps_ns, *columns)


class StampedReader:
    """Read numbers of messages that begin with a header."""

    def __init__(
        self, type_name: str, offsets_of: Callable[[CdrCursor], Sequence[int | None]]
    ) -> None:
        self._type_name = type_name
        self._offsets_of = offsets_of
        self._layouts: dict[int, StampedLayout] = {}  # by size of the message

    def read(self, raw: bytes) -> tuple[Any, ...]:
        """Read one message."""
        layout = self._layouts.get(len(raw))
        values = layout.read(raw) if layout is not None else None
        return values or self._new_layout(raw).read(raw)  # type: ignore[return-value]

    def read_many(self, raws: Sequence[bytes]) -> tuple[Any, ...] | None:
        """
        Read many messages of one frame at once.

        Returns columns: frame, stamps [ns] and the wanted numbers, as ndarrays of shape (N,); None
        if the messages differ in structure and must be read one by one
        """
        try:
            frame_id = self.read(raws[0])[2]
        except MessageError:
            return None
        columns = self._layouts[len(raws[0])].read_many(raws)
        return None if columns is None else (frame_id, *columns)

    def _new_layout(self, raw: bytes) -> StampedLayout:
        """Find the layout of a message."""
        try:
            cursor = CdrCursor(raw)
            cursor.skip(8)
            frame_id = cursor.text()
            offsets = self._offsets_of(cursor)
        except MessageError:
            raise
        except ValueError as error:
            raise malformed(raw, self._type_name, error) from error
        if len(self._layouts) >= _MOST_LAYOUTS:
            self._layouts.clear()
        layout = self._layouts[len(raw)] = StampedLayout(cursor, frame_id, offsets)
        return layout


def header_stamp_ns(raw: bytes) -> int | None:
    """Return the stamp of a message that begins with a header [ns]; None if it is too short."""
    if len(raw) < 12:
        return None
    sec, nanosec = struct.unpack_from('<iI' if raw[1] else '>iI', raw, _ENCAPSULATION)
    return int(sec * NS_PER_S + nanosec)


def whole(raw: bytes, type_name: str, read: Callable[[CdrCursor], Content]) -> Content:
    """Read a whole message, whose every byte is at its place."""
    try:
        cursor = CdrCursor(raw)
        content = read(cursor)
        cursor.finish()
    except ValueError as error:
        raise malformed(raw, type_name, error) from error
    return content


def malformed(raw: bytes, type_name: str, error: ValueError) -> MessageError:
    """Explain that bytes are not a message of a type."""
    return MessageError(
        'malformed',
        f'{len(raw)} bytes are not a {type_name}: {error}; '
        'check that publisher and subscriber use the same message definition',
    )
