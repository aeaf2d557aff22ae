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

"""Where the numbers of a message are, by name: reading, setting and listing them."""

from __future__ import annotations

from typing import Any, NamedTuple, Sequence

from .codec import Codec

INT32 = 'i'
UINT32 = 'I'
FLOAT64 = 'd'


class Field(NamedTuple):
    """
    One number of a message.

    Attributes
    ----------
    path : tuple of str or int
        Attribute names and list positions from the message to the number's owner.
    name : str
        Attribute that holds the number or the sequence of numbers.
    place : int
        Place in the sequence; -1 where the attribute is the number itself.
    kind : str
        Code of the struct module.

    """

    path: tuple[str | int, ...]
    name: str
    place: int
    kind: str

    def value(self, message: Any) -> Any:
        """Read the number from a message object."""
        held = getattr(_owner(message, self.path), self.name)
        return held if self.place < 0 else float(held[self.place])  # not a numpy scalar


def scalars(path: tuple[str | int, ...], kinds: dict[str, str]) -> list[Field]:
    """List the plain numbers of one owner, given their names and kinds."""
    return [Field(path, name, -1, kind) for name, kind in kinds.items()]


def sequences(message: Any, path: tuple[str | int, ...], names: Sequence[str]) -> list[Field]:
    """List the elements that the float64 sequences of one owner have in this message."""
    owner = _owner(message, path)
    return [
        Field(path, name, place, FLOAT64)
        for name in names
        for place in range(len(getattr(owner, name)))
    ]


def stamp_fields() -> list[Field]:
    """List the numbers of `message.header.stamp`."""
    return scalars(('header', 'stamp'), {'sec': INT32, 'nanosec': UINT32})


def set_values(message: Any, fields: Sequence[Field], values: Sequence[Any], codec: Codec) -> None:
    """
    Set all numbers of a message.

    Sequences are replaced whole, because those of a deserialised message may be read-only; so
    `fields` must name every element of a sequence, in order.

    Parameters
    ----------
    message : object
        Changed in place.
    fields : sequence of Field
        The numbers.
    values : sequence of int or float
        One value per field.
    codec : Codec
        The library that built the message.

    """
    arrays: dict[tuple[tuple[str | int, ...], str], list[Any]] = {}
    for field, value in zip(fields, values):
        if field.place < 0:
            setattr(_owner(message, field.path), field.name, value)
        else:
            arrays.setdefault((field.path, field.name), []).append(value)
    for (path, name), elements in arrays.items():
        setattr(_owner(message, path), name, codec.floats(elements))


def _owner(message: Any, path: tuple[str | int, ...]) -> Any:
    """Follow attribute names and list positions."""
    for step in path:
        message = message[step] if isinstance(step, int) else getattr(message, step)
    return message
