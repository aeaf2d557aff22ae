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

"""The library behind the bytes: one protocol for rosbags (off-line) and rclpy (on-line)."""

from __future__ import annotations

from typing import Any, Protocol, Sequence

import numpy as np

from .typestore import jazzy_typestore

_LARGEST_SLACK = 64


class Codec(Protocol):
    """
    What decoders and encoders need from a message library.

    Messages are duck-typed: `message.header.stamp.sec`, `message.wrench.force.x`,
    `message.position[0]` mean the same in rosbags and in rclpy.

    """

    def serialize(self, message: Any, type_name: str) -> bytes:
        """Turn a message into CDR with its encapsulation header."""

    def deserialize(self, data: bytes, type_name: str) -> Any:
        """Turn CDR into a message; any exception means that the bytes are malformed."""

    def new(self, type_name: str) -> Any:
        """Build a message with default values whose nested fields can be set."""

    def floats(self, values: Sequence[float]) -> Any:
        """Convert numbers to what the library wants in a float64 sequence field."""


class RosbagsCodec:
    """
    Codec of the pure Python package rosbags with the message types of ROS 2 Jazzy.

    Raises
    ------
    MissingPackageError
        If rosbags is not installed.

    """

    def __init__(self) -> None:
        self._store = jazzy_typestore()

    def serialize(self, message: Any, type_name: str) -> bytes:
        """Turn a message into little-endian CDR with its encapsulation header."""
        return bytes(self._store.serialize_cdr(message, type_name, little_endian=True))

    def deserialize(self, data: bytes, type_name: str) -> Any:
        """Turn CDR into a message; any exception means that the bytes are malformed."""
        try:
            return self._store.deserialize_cdr(data, type_name)
        except Exception as error:
            if 'size mismatch' not in str(error):
                raise
            return self._deserialize_with_slack(data, type_name)

    def _deserialize_with_slack(self, data: bytes, type_name: str) -> Any:
        """
        Read a message behind which its buffer goes on.

        rmw_fastrtps takes buffers of the largest size that alignment could need, so that a joint
        state without effort ends in four bytes of nothing, which rosbags refuses.

        """
        for cut in range(4, min(_LARGEST_SLACK, len(data) - 4) + 1, 4):
            try:
                return self._store.deserialize_cdr(data[:-cut], type_name)
            except Exception as error:
                if 'size mismatch' not in str(error):
                    raise
        raise ValueError(f'more than {_LARGEST_SLACK} bytes behind a {type_name}')

    def new(self, type_name: str) -> Any:
        """
        Build a message with default values whose nested fields can be set.

        Parameters
        ----------
        type_name : str
            Such as 'geometry_msgs/msg/WrenchStamped'.

        Returns
        -------
        message : object
            Zeros, empty texts and empty sequences. Defaults written in a message definition are
            not known to rosbags; no type used here has one.

        """
        fields = self._store.fielddefs[type_name][1]
        return self._store.types[type_name](
            **{name: self._default(*description) for name, description in fields}
        )

    def floats(self, values: Sequence[float]) -> Any:
        """Convert numbers to the array that rosbags wants in a float64 sequence field."""
        return np.asarray(values, dtype=np.float64)

    def _default(self, node: Any, content: Any) -> Any:
        """Build the default value of one field from its description in the typestore."""
        if node.name == 'NAME':
            return self.new(content)
        if node.name == 'BASE':
            return _default_of_base(content[0])
        (element_node, element), count = content
        length = count if node.name == 'ARRAY' else 0
        if element_node.name == 'BASE' and element[0] != 'string':
            return np.zeros(length, dtype=_array_type(element[0]))
        return [self._default(element_node, element) for _ in range(length)]


def _default_of_base(name: str) -> bool | int | float | str:
    """Return the zero of a primitive type."""
    if name == 'string':
        return ''
    if name == 'bool':
        return False
    return 0.0 if name.startswith('float') else 0


def _array_type(name: str) -> Any:
    """Name the numpy type of a primitive type; 'octet', 'byte' and 'char' are bytes in ROS 2."""
    return np.dtype('uint8' if name in ('octet', 'byte', 'char') else name)
