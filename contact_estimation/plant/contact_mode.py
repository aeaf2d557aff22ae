# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Which equation of contact holds at an instant."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class Mode(Enum):
    """Which equation of contact holds; each equation is smooth."""

    FREE = 'free'
    PRESSING = 'pressing'
    SLACK = 'slack'
    """The surface is reached, but the force is 0 or at the largest pull."""

    HELD = 'held'
    """Out of contact, but the wall still pulls."""


FREE, PRESSING, SLACK, HELD = Mode  # attribute access of an enumeration is slow


class Instant(NamedTuple):
    """Acceleration [m/s^2] and F_e [N] under the equation that holds."""

    acceleration: float
    force: float
    mode: Mode
