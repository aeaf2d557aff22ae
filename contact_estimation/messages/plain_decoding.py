# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Raw messages of a single number or text, and diagnostics, to plain values."""

from __future__ import annotations

from struct import unpack_from
from typing import NamedTuple

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


DIAGNOSTICS_TYPE = 'diagnostic_msgs/msg/DiagnosticArray'


class DiagnosticReading(NamedTuple):
    """One status of a diagnostic message."""

    level: int  # 0 for OK, 1 for WARN, 2 for ERROR, 3 for STALE
    name: str  # of the component
    message: str  # its state in a sentence
    values: dict[str, str]  # by key


def decode_diagnostics(raw: bytes) -> list[DiagnosticReading]:
    """Read diagnostic_msgs/msg/DiagnosticArray."""
    try:
        cursor = CdrCursor(raw)
        cursor.skip(8, 4)  # stamp
        cursor.text()
        statuses = [_status(cursor) for _ in range(cursor.length())]
        cursor.finish()
    except ValueError as error:
        raise malformed(raw, DIAGNOSTICS_TYPE, error) from error
    return statuses


def _status(cursor: CdrCursor) -> DiagnosticReading:
    level = cursor.raw[cursor.skip(1)]
    name, message, _ = cursor.text(), cursor.text(), cursor.text()  # the last is the hardware
    values = {}
    for _ in range(cursor.length()):
        key = cursor.text()
        values[key] = cursor.text()
    return DiagnosticReading(level, name, message, values)
