# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Percentiles of a latency."""

from __future__ import annotations

from typing import Sequence


def percentiles(values: Sequence[float]) -> dict[str, float | None]:
    """Return median, 99th percentile and maximum."""
    ordered = sorted(values)
    if not ordered:
        return {'p50': None, 'p99': None, 'max': None}
    last = len(ordered) - 1
    return {
        'p50': ordered[min(last, len(ordered) // 2)],
        'p99': ordered[min(last, int(0.99 * len(ordered)))],
        'max': ordered[-1],
    }
