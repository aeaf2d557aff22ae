# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Raw messages of a single number or text."""

from __future__ import annotations

from struct import unpack_from

from .cdr import CdrCursor, malformed


FLOAT64_TYPE = 'std_msgs/msg/Float64'
STRING_TYPE = 'std_msgs/msg/String'


def decode_float64(raw: bytes) -> float:
    """Read std_msgs/msg/Float64."""
    try:
        cursor = CdrCursor(raw)
        (begin,) = cursor.doubles(1)
        cursor.finish()
    except ValueError as error:
        raise malformed(raw, FLOAT64_TYPE, error) from error
    return float(unpack_from(cursor.byte_order + 'd', raw, begin)[0])


def decode_string(raw: bytes) -> str:
    """Read std_msgs/msg/String."""
    try:
        cursor = CdrCursor(raw)
        text = cursor.text()
        cursor.finish()
    except ValueError as error:
        raise malformed(raw, STRING_TYPE, error) from error
    return text
