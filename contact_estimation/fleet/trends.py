# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Wear and drift: the trend of K_e and B_e over the recordings of a group."""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import theilslopes

from .entry import distinct, Entry

Array = NDArray[np.float64]

QUANTITIES = {'stiffness': ('K_e', 'N/m'), 'damping': ('B_e', 'N s/m')}
_LEAST = 6  # recordings: fewer have no 95 % interval of Sen's kind worth the name
_LEVEL = 0.95
_RESOLVED = 2.0  # standard deviations of one recording: less may be the model's own error
_DAY_NS = 86_400e9


class Trend(NamedTuple):
    """The trend of a quantity in a group."""

    # group, quantity: the latter a key of `QUANTITIES`
    group: str
    quantity: str
    numbers: NDArray[np.int64]  # (N,) recording in the group, from 1
    # values, stds (N,): of the corrected models
    values: Array
    stds: Array
    slope: float  # median slope per recording (Theil-Sen); NaN with too few recordings
    # low, high: its 95 % interval (Sen 1968)
    low: float
    high: float
    intercept: float  # of the line, at number 0
    per_day: float  # median slope per day; NaN where the stamps do not tell days
    # whether the interval at a level corrected for the number of trends (Bonferroni) excludes 0,
    # and the change over all recordings is resolved
    significant: bool

    def percent(self, slope: float) -> float:
        """Convert a slope."""
        return 100.0 * slope / abs(self.intercept + self.slope * float(self.numbers[0]))


def trends(entries: Sequence[Entry]) -> list[Trend]:
    """Fit the trends of all groups."""
    groups = by_group(entries)
    count = len(groups) * len(QUANTITIES)
    found = [_trend(group, quantity, members, count)
             for group, members in groups.items() for quantity in QUANTITIES]
    return [trend for trend in found if trend is not None]


def is_resolved(change: float, stds: Array) -> bool:
    """Return whether a change is more than what single recordings leave open."""
    return abs(change) > _RESOLVED * float(np.median(stds))


def by_group(entries: Sequence[Entry]) -> dict[str, list[Entry]]:
    """Sort recordings into their groups."""
    return {group: [entry for entry in entries if entry.group == group]
            for group in sorted({entry.group for entry in entries})}


def _trend(group: str, quantity: str, members: Sequence[Entry], count: int) -> Trend | None:
    used = {id(entry) for entry in distinct(members)}
    known = [(number, entry.outcome['start_ns'], *value)
             for number, entry in enumerate(members, 1)
             if id(entry) in used and (value := entry.corrected(quantity)) is not None]
    if not known:
        return None
    numbers, starts, values, stds = (np.array(column) for column in zip(*known))
    slope = low = high = intercept = per_day = np.nan
    significant = False
    if len(known) >= _LEAST:
        slope, intercept, low, high = theilslopes(values, numbers, _LEVEL)
        _, _, *corrected = theilslopes(values, numbers, 1.0 - (1.0 - _LEVEL) / count)
        change = abs(slope) * (numbers[-1] - numbers[0])
        significant = bool((corrected[0] > 0.0 or corrected[1] < 0.0)
                           and is_resolved(change, stds))
        if len(set(starts.tolist())) == len(starts):
            per_day = theilslopes(values, (starts - starts[0]) / _DAY_NS)[0]
    return Trend(group, quantity, numbers, values, stds, float(slope), float(low), float(high),
                 float(intercept), float(per_day), significant)
