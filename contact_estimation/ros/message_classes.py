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

"""Message classes by type name."""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module
from typing import Any

from ..messages.transforms import TRANSFORMS_TYPE


def has_transforms() -> bool:
    """Return whether the messages of tf are installed, which rclpy does not need."""
    try:
        message_class(TRANSFORMS_TYPE)
    except ImportError:
        return False
    return True


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
