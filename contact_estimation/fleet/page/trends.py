# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""K_e and B_e of each group over its recordings, with their trends."""

from __future__ import annotations

from math import isfinite
from typing import Any

from .figures import plot_trend
from .wording import signed_percents
from ..findings import QUANTITIES, Trend, trends
from ..run import Fleet


def prepare(fleet: Fleet) -> dict[str, Any] | None:
    """Return a row and a figure for each group and quantity; None without any value."""
    found = trends(fleet.entries)
    if not found:
        return None
    named = {entry.group: [] for entry in fleet.entries}  # type: dict[str, list[bool]]
    for entry in fleet.entries:
        named[entry.group].append(bool(entry.families))
    return {
        'rows': [_row(trend) for trend in found],
        'figures': [(f'{QUANTITIES[trend.quantity][0]} of {trend.group} over its recordings',
                     plot_trend(trend, named[trend.group])) for trend in found],
        'per_day': any(isfinite(trend.per_day) for trend in found),
    }


def _row(trend: Trend) -> dict[str, Any]:
    symbol, unit = QUANTITIES[trend.quantity]
    slope, low, high, per_day = signed_percents(trend)
    return {
        'group': trend.group, 'symbol': f'{symbol} [{unit}]', 'count': len(trend.values),
        'first': trend.intercept + trend.slope * float(trend.numbers[0]),
        'slope': slope, 'interval': f'{low} to {high}' if slope else '', 'per_day': per_day,
        'significant': trend.significant,
    }
