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

"""The message library of a running ROS node, for the decoders and encoders."""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module
from typing import Any, Sequence

from rclpy.serialization import deserialize_message, serialize_message


@lru_cache(maxsize=None)
def message_class(type_name: str) -> Any:
    """
    Import the class of a message type.

    Parameters
    ----------
    type_name : str
        Such as 'geometry_msgs/msg/WrenchStamped'.

    Returns
    -------
    cls : type
        The class that rosidl generated.

    """
    package, kind, name = type_name.split('/')
    return getattr(import_module(f'{package}.{kind}'), name)


class RclpyCodec:
    """`messages.codec.Codec` with rclpy's own serialisation."""

    def serialize(self, message: Any, type_name: str) -> bytes:
        """Return the CDR of a message with its encapsulation header."""
        return bytes(serialize_message(message))

    def deserialize(self, data: bytes, type_name: str) -> Any:
        """Return the message of a CDR."""
        return deserialize_message(data, message_class(type_name))

    def new(self, type_name: str) -> Any:
        """Return a message with default values."""
        return message_class(type_name)()

    def floats(self, values: Sequence[float]) -> Any:
        """Return numbers as a float64 sequence field requires."""
        return [float(value) for value in values]
