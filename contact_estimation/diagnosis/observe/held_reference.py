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

"""
A reference that the robot holds from one setpoint to the next.

Straight lines between setpoints are the usual assumption. A robot that holds each until the next
follows them half a period later, which looks like a delay of its command.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .signals import Recording

Array = NDArray[np.float64]

_APART = 1.0 - 1e-9  # ramps that meet must not overlap by rounding


def with_held_reference(recording: Recording) -> Recording:
    """Let a robot hold its reference."""
    s = recording.signals
    if len(s.reference_t) < 2:
        return recording
    reference = held_at(s.wrench_t, s.reference_t, s.reference)
    return Recording(recording.name, s._replace(reference_t=s.wrench_t, reference=reference))


def held_at(t: Array, stamps: Array, values: Array) -> Array:
    """Sample values that are held from stamp to stamp."""
    periods = np.diff(stamps, prepend=stamps[0] - (stamps[1] - stamps[0]))
    width = np.minimum(periods, float(np.median(np.diff(t))))
    width[:-1] = _APART * np.minimum(width[:-1], width[1:])
    corners = np.column_stack((stamps - 0.5 * width, stamps + 0.5 * width)).ravel()
    before = np.concatenate((values[:, :1], values[:, :-1]), axis=1)
    levels = np.stack((before, values), axis=2).reshape(len(values), -1)
    return np.array([np.interp(t, corners, row) for row in levels])
