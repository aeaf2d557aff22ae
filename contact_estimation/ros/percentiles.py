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

"""Percentiles of a latency."""

from __future__ import annotations

from typing import Sequence


def percentiles(values: Sequence[float]) -> dict[str, float | None]:
    """
    Return median, 99th percentile and maximum.

    Parameters
    ----------
    values : sequence of float
        In any order.

    Returns
    -------
    figures : dict
        p50, p99, max; None each without values.

    """
    ordered = sorted(values)
    if not ordered:
        return {'p50': None, 'p99': None, 'max': None}
    last = len(ordered) - 1
    return {
        'p50': ordered[min(last, len(ordered) // 2)],
        'p99': ordered[min(last, int(0.99 * len(ordered)))],
        'max': ordered[-1],
    }
