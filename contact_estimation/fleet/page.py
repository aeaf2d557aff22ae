# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The fleet as one self-contained HTML page; `fleet.html` is its text."""

from collections import Counter
from datetime import datetime, timezone
from math import floor, isfinite, log10
from typing import Any, Sequence

import numpy as np

from .findings import by_group, differences, QUANTITIES, Trend, trends
from .run import Fleet
from .table import Entry
from ..diagnosis.report import page as diagnosis_page
from ..figures import BLUE, figure_style, INK, MUTED, new_figure, ORANGE

_OUTSIDE = 6.0  # interquartile ranges around the quartiles: values beyond are not shown


@figure_style()
def plot_trend(trend: Trend, named: Sequence[bool]) -> Any:
    """Plot a quantity over the recordings of a group, with its trend."""
    symbol, unit = QUANTITIES[trend.quantity]
    figure, axis = new_figure((5.6, 3.0))
    with_name = np.array(named)[trend.numbers - 1]
    for mask, colour, label in ((~with_name, BLUE, 'nothing named'),
                                (with_name, ORANGE, 'effect named')):
        if mask.any():
            axis.errorbar(trend.numbers[mask], trend.values[mask], 2.0 * trend.stds[mask],
                          fmt='o', markersize=3.0, linewidth=0.8, color=colour, label=label)
    if np.isfinite(trend.slope):
        x = trend.numbers[[0, -1]]
        axis.plot(x, trend.intercept + trend.slope * x, color=INK, linewidth=1.2,
                  linestyle='-' if trend.significant else ':', label='trend')
    axis.set_ylim(*_limits(trend))
    axis.set_title(f'{trend.group}: {symbol} [{unit}]')
    axis.set_xlabel('recording of the group')
    axis.xaxis.get_major_locator().set_params(integer=True)
    axis.legend(loc='best', ncols=3)
    return figure


def _limits(trend: Trend) -> tuple[float, float]:
    """Return limits that show all values but extreme outliers, and at least 2 % of the median."""
    low, middle, high = np.percentile(trend.values, (25, 50, 75))
    reach = _OUTSIDE * max(high - low, 0.002 * abs(middle), 1e-12)
    kept = (trend.values > low - reach) & (trend.values < high + reach)
    ends = np.concatenate((trend.values[kept] - 2.0 * trend.stds[kept],
                           trend.values[kept] + 2.0 * trend.stds[kept]))
    ends = ends[np.isfinite(ends)]
    centre, half = 0.5 * (ends.min() + ends.max()), 0.6 * (ends.max() - ends.min())
    half = max(half, 0.01 * abs(middle), 1e-12)
    return float(centre - half), float(centre + 1.15 * half)  # room for the legend


@figure_style()
def plot_names(entries: Sequence[Entry]) -> Any:
    """Plot which families are named in which recording."""
    rows = sorted({(entry.group, family) for entry in entries for family in entry.families})
    groups = list(dict.fromkeys(group for group, _ in rows))
    figure, axis = new_figure((7.0, 1.0 + 0.3 * len(rows)))
    for place, (group, family) in enumerate(rows):
        members = [entry.number for entry in entries if entry.group == group]
        named = [entry.number for entry in entries
                 if entry.group == group and family in entry.families]
        axis.plot(members, [place] * len(members), '|', color=MUTED, markersize=3.0, alpha=0.6)
        axis.plot(named, [place] * len(named), '|', markersize=9.0, markeredgewidth=1.6,
                  color=(BLUE, ORANGE)[groups.index(group) % 2])
    axis.set_yticks(range(len(rows)), [f'{group}: {words(family)}' for group, family in rows])
    axis.set_ylim(len(rows) - 0.4, -0.6)
    axis.set_xlim(0.0, max(entry.number for entry in entries) + 1.0)
    axis.set_xlabel('recording, in order of time')
    axis.grid(False)
    return figure


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


def as_html(fleet: Fleet) -> str:
    """Build the page."""
    environment = diagnosis_page.environment(__package__, 'contact_estimation.diagnosis.report')
    environment.filters.update(
        words=words, start=start_of, chance=probability, signed_percents=signed_percents,
        naming=lambda entries, name: [one for one in entries if name in one.names])
    groups, found = by_group(fleet.entries), trends(fleet.entries)
    verdicts = Counter(one.report['verdict'] for one in fleet.entries if one.report)
    names = sorted({name for one in fleet.entries for name in one.names})
    return environment.get_template('fleet.html').render(
        verdict='fleet', title=f'{len(fleet.entries)} recordings', fleet=fleet, groups=groups,
        quantities=QUANTITIES, verdicts=verdicts.most_common(), names=names,
        names_figure=names and plot_names(fleet.entries),
        trends=found, trend_plots=[
            plot_trend(trend, [bool(entry.families) for entry in groups[trend.group]])
            for trend in found],
        differences=differences(fleet.entries))
