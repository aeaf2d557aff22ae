# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

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
    """Import the class of a message type."""
    package, kind, name = type_name.split('/')
    return getattr(import_module(f'{package}.{kind}'), name)
