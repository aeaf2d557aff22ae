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
