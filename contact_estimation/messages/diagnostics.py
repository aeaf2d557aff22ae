# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""diagnostic_msgs/msg/DiagnosticArray to plain texts."""

from __future__ import annotations

from typing import NamedTuple

from .cdr import CdrCursor, malformed

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
