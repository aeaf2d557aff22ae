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

"""Reading numbers from raw messages: by a learned layout where possible, else by the library."""

from __future__ import annotations

import struct
from typing import Any, Callable, NamedTuple, Sequence

from .codec import Codec
from .fields import Field
from .layout import ReadingLayout
from .locating import locate
from ..exceptions import MessageError

_LITTLE_ENDIAN_CDR = b'\x00\x01'
# rmw_fastrtps sizes buffers for the worst alignment, so bytes may follow the message.
_TRAILING_PADDING = 64
_CACHED_LAYOUTS = 8
# Learning costs three passes through the library. A publisher that changes its texts at every
# message would make each message pay that; after this many the library reads what is unknown.
_MAXIMUM_LESSONS = 64
# Finding markers in a trajectory of a thousand points would take longer than one period.
_MAXIMUM_FIELDS = 64


class Plan(NamedTuple):
    """
    What to read from messages of one structure.

    Attributes
    ----------
    fields : list of Field
        All numbers of the message, so that none is taken for structure.
    wanted : tuple of Field or None
        The numbers to read, in order, at least one; None where the message has none.
    note : str
        A text to hand out with the numbers.
    trouble : MessageError or None
        Why messages of this structure cannot be used.

    """

    fields: list[Field]
    wanted: tuple[Field | None, ...]
    note: str = ''
    trouble: MessageError | None = None


class Lesson(NamedTuple):
    """One learned structure: `identity` is all that the library sees besides the numbers."""

    identity: str
    layout: ReadingLayout
    plan: Plan


class NumberReader:
    """
    Reads the numbers that a plan wants from raw messages.

    Parameters
    ----------
    codec : Codec
        The library that knows the message type.
    type_name : str
        Such as 'geometry_msgs/msg/WrenchStamped'.
    make_plan : callable
        Gets a deserialised message, returns its plan.

    Attributes
    ----------
    note : str
        The plan's note for the message read last.

    """

    def __init__(
        self, codec: Codec, type_name: str, make_plan: Callable[[Any], Plan]
    ) -> None:
        self.note = ''
        self._codec = codec
        self._type_name = type_name
        self._make_plan = make_plan
        self._lessons: list[Lesson] = []  # most recently used first
        self._lessons_given = 0
        self._read_recent: Callable[[bytes], tuple[Any, ...] | None] = _nothing_learned

    def read(self, raw: bytes) -> tuple[Any, ...]:
        """
        Read the wanted numbers of one message.

        Parameters
        ----------
        raw : bytes
            CDR with its encapsulation header.

        Returns
        -------
        numbers : tuple
            In the order of the plan, NaN where the message has none.

        Raises
        ------
        MessageError
            If the message is malformed or its plan says that it is of no use.

        """
        return self._read_recent(raw) or self._read_other(raw)

    def read_many(self, raws: Sequence[bytes]) -> tuple[Any, ...] | None:
        """
        Read the wanted numbers of many messages at once.

        Parameters
        ----------
        raws : sequence of bytes
            Messages, at least one.

        Returns
        -------
        columns : tuple of ndarray, shape (N,), or None
            In the order of the plan; None where the messages are not all of one structure:
            then `read` says what is the matter.

        """
        try:
            self.read(raws[0])
        except MessageError:
            return None
        return self._lessons[0].layout.read_many(raws) if self._lessons else None

    def _read_other(self, raw: bytes) -> tuple[Any, ...]:
        """Read a message whose structure is not that of the last one."""
        for place, lesson in enumerate(self._lessons):
            numbers = lesson.layout.read(raw)
            if numbers is not None:
                self._lessons.insert(0, self._lessons.pop(place))
                return self._hand_out(lesson, numbers)
        self._read_recent = _nothing_learned  # its note would not be this message's
        message, plan = self._deserialize(raw)
        numbers = _values(message, plan.wanted)
        if self._can_be_learned(raw, plan):
            self._learn(raw, message, plan)
        if plan.trouble is not None:
            raise _fresh(plan.trouble)
        self.note = plan.note
        return numbers

    def _hand_out(self, lesson: Lesson, numbers: tuple[Any, ...]) -> tuple[Any, ...]:
        """Make a known structure the first to be tried, if it is of use."""
        if lesson.plan.trouble is not None:
            raise _fresh(lesson.plan.trouble)
        self.note = lesson.plan.note
        self._read_recent = lesson.layout.read
        return numbers

    def _deserialize(self, raw: bytes) -> tuple[Any, Plan]:
        """Let the library read the message."""
        try:
            message = self._codec.deserialize(raw, self._type_name)
        except Exception as error:  # each library has its own exceptions for bad bytes
            raise MessageError(
                'malformed',
                f'{len(raw)} bytes are not a {self._type_name}: {error}; '
                'check that publisher and subscriber use the same message definition',
            ) from error
        return message, self._make_plan(message)

    def _can_be_learned(self, raw: bytes, plan: Plan) -> bool:
        """Tell whether a layout is possible and worth its price."""
        return (
            raw[:2] == _LITTLE_ENDIAN_CDR
            and len(plan.fields) <= _MAXIMUM_FIELDS
            and self._lessons_given < _MAXIMUM_LESSONS
        )

    def _learn(self, raw: bytes, message: Any, plan: Plan) -> None:
        """Find the layout of a message; its numbers are overwritten."""
        self._lessons_given += 1
        originals = _values(message, plan.fields)
        marked = locate(self._codec, message, self._type_name, plan.fields)
        if marked is None or not 0 <= len(raw) - len(marked.data) <= _TRAILING_PADDING:
            return
        for slot, value in zip(marked.slots, originals):
            if struct.pack('<' + slot.kind, value) != raw[slot.offset:slot.end]:
                return  # this message was not laid out as the library does it
        wanted = [None if f is None else plan.fields.index(f) for f in plan.wanted]
        identity = repr(message)
        padding = frozenset(range(len(marked.data), len(raw))).union(
            *(self._padding(lesson, identity, raw) for lesson in self._lessons)
        )
        layout = ReadingLayout(raw, marked.slots, wanted, padding)
        lesson = Lesson(identity, layout, plan)
        known = [old for old in self._lessons if (old.identity, old.layout.size)
                 != (identity, len(raw))]
        self._lessons = [lesson, *known][:_CACHED_LAYOUTS]
        if plan.trouble is None:
            self._read_recent = layout.read

    @staticmethod
    def _padding(lesson: Lesson, identity: str, raw: bytes) -> frozenset[int]:
        """
        Find the bytes that differ although the library sees the same message.

        Fast CDR leaves whatever was in memory in the bytes that align numbers, and each
        publisher leaves something else there.

        """
        if lesson.identity != identity or lesson.layout.size != len(raw):
            return frozenset()
        return lesson.layout.ignored | lesson.layout.structural_difference(raw)


def _values(message: Any, fields: Sequence[Field | None]) -> tuple[Any, ...]:
    """Read fields from a message object."""
    return tuple(float('nan') if field is None else field.value(message) for field in fields)


def _fresh(trouble: MessageError) -> MessageError:
    """Copy an error: raising the same object again would grow its traceback without end."""
    return MessageError(trouble.reason, str(trouble))


def _nothing_learned(raw: bytes) -> None:
    """Stand in for a layout until one is learned."""
