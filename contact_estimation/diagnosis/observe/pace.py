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

"""The pace of a recording: from creep tests over hours to bursts of a fraction of a second."""

from __future__ import annotations

_FASTEST_S, _SLOWEST_S = 0.9e-3, 1.1e-2  # sample periods between which the pace is 1
_SHORT_S = 2.0  # duration below which times shrink


def pace_of(h: float, duration: float) -> float:
    """
    Return the factor on all times of the diagnosis.

    Its times (windows, blocks, memories) suit contacts that are sampled at 100 Hz to 1 kHz for
    seconds. Slower sampling lengthens them, so that they hold as many samples as at 100 Hz; faster
    sampling and a short recording shorten them.
    """
    by_rate = max(h / _SLOWEST_S, min(1.0, h / _FASTEST_S))
    return min(by_rate, duration / _SHORT_S) if duration > 0.0 else by_rate


def is_slow(h: float) -> bool:
    """Return whether sampling is too slow to take the motion between samples for known."""
    return h > _SLOWEST_S
