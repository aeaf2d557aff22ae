# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Words shared by the sections."""

from __future__ import annotations

from datetime import datetime, timezone
from math import floor, isfinite, log10

from ..findings import Trend
from ..table import Entry

_YEAR_NS = 31_557_600 * 10**9
_MOST_DECIMALS = 9


def words(name: str) -> str:
    """Return a name of the library as words: 'coulomb friction'."""
    return name.replace('_', ' ')


def start_of(entry: Entry) -> str:
    """Return when a recording began."""
    start_ns = entry.outcome['start_ns']
    if start_ns is None or start_ns < _YEAR_NS:
        return ''
    return datetime.fromtimestamp(start_ns // 10**9, timezone.utc).strftime('%Y-%m-%d %H:%M')


def signed_percents(trend: Trend) -> tuple[str, str, str, str]:
    """Return a trend as percentages with their signs."""
    width = abs(trend.percent(trend.high) - trend.percent(trend.low))
    shown = isfinite(width) and width > 0.0
    decimals = min(max(3, 1 - floor(log10(width))), _MOST_DECIMALS) if shown else 3
    slope, low, high, per_day = (
        _signed(trend.percent(value), decimals)
        for value in (trend.slope, trend.low, trend.high, trend.per_day))
    return slope, low, high, per_day


def _signed(value: float, decimals: int) -> str:
    text = f'{value:+.{decimals}f}' if isfinite(value) else ''
    return text[1:] if text and float(text) == 0.0 else text


def probability(chance: float) -> str:
    """Return a p-value in words."""
    return 'p < 0.0001' if chance < 1e-4 else f'p = {chance:.2g}'
