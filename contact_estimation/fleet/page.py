# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The fleet as one self-contained HTML page, `fleet.html`.

`prepare_NAME` makes the data of a section; one whose data are None is left out.
"""

from collections import Counter
from datetime import datetime, timezone
from math import floor, isfinite, log10
from typing import Any, Sequence

import numpy as np

from .findings import by_group, differences, QUANTITIES, Trend, trends
from .run import Fleet, PooledResult
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


def prepare_changes(fleet: Fleet) -> dict[str, Any] | None:
    """Return the changes and a figure of all names; None where nothing is named."""
    if not any(entry.families for entry in fleet.entries):
        return None
    return {
        'changes': [
            {'change': change, 'family': words(change.family), 'start': start_of(change.entry),
             'chance': probability(change.chance)}
            for change in fleet.changes],
        'figure': plot_names(fleet.entries),
    }


def prepare_differences(fleet: Fleet) -> dict[str, Any] | None:
    """Return a row for each difference; None with a single group."""
    if len({entry.group for entry in fleet.entries}) < 2:
        return None
    return {'rows': [
        {'one': one, 'chance': probability(one.chance),
         'what': ' '.join((QUANTITIES[one.what][0], f'[{QUANTITIES[one.what][1]}]'))
         if one.is_quantity else words(one.what)}
        for one in differences(fleet.entries)
    ]}


def prepare_errors(fleet: Fleet) -> dict[str, Any] | None:
    """Return the recordings with an error or a failed check; None if there are none."""
    found = [(entry, entry.outcome['error']) for entry in fleet.failed]
    for entry in fleet.entries:
        if entry.outcome['report'] and entry.report is None:
            found.append((entry, '; '.join(
                f'{words(check["name"])}: {check["text"]}'
                for check in entry.outcome['report']['checks'] if not check['ok'])))
    return {'found': found} if found else None


def prepare_names(fleet: Fleet) -> dict[str, Any] | None:
    """Return the counts of each name in each group; None where nothing is named."""
    groups = by_group(fleet.entries)
    names = sorted({effect['name'] for entry in fleet.entries for effect in entry.effects})
    if not names:
        return None
    return {
        'names': [words(name) for name in names],
        'rows': [{'group': group,
                  'diagnosed': sum(entry.report is not None for entry in members),
                  'cells': [_cell(members, name) for name in names]}
                 for group, members in groups.items()],
    }


def _cell(members: Sequence[Entry], name: str) -> dict[str, Any] | None:
    """Return how often a name occurs, and where first."""
    named = [entry for entry in members if any(effect['name'] == name for effect in entry.effects)]
    if not named:
        return None
    return {'count': len(named), 'entry': named[0], 'start': start_of(named[0])}


def prepare_pooled(fleet: Fleet) -> dict[str, Any] | None:
    """Return the pooled diagnosis of each group; None if there is none."""
    return {'groups': [_group(one) for one in fleet.pooled]} if fleet.pooled else None


def _group(result: PooledResult) -> dict[str, Any]:
    report = result.whole['report']
    families = _families(report)
    rows = [_left_out(entry, outcome, families)
            for entry, outcome in zip(result.pool.members, result.left_out)]
    return {
        'name': result.pool.group, 'since': result.pool.since, 'page': result.page,
        'report': report, 'error': result.whole['error'], 'rows': rows,
        'verdict': words(report['verdict']) if report else '',
        'same': sum(row['same'] for row in rows),
    }


def _left_out(entry: Entry, outcome: dict[str, Any], families: list[str]) -> dict[str, Any]:
    """Return what the other recordings name, and how they predict the one left out."""
    report = outcome['report']
    if report is None:
        return {'entry': entry, 'same': False, 'force': None, 'error': outcome['error']}
    return {'entry': entry, 'same': _families(report) == families,
            'names': [words(effect['name']) for effect in report['effects']],
            'force': report['fit']['force_rmse_n'], 'noise': report['fit']['noise_floor_n']}


def _families(report: dict[str, Any] | None) -> list[str]:
    return sorted({effect['family'] for effect in report['effects']}) if report else []


def prepare_recordings(fleet: Fleet) -> dict[str, Any]:
    """Return the recordings of each group."""
    groups = by_group(fleet.entries)
    return {'groups': [(group, [_row(entry) for entry in members])
                       for group, members in groups.items()]}


def _row(entry: Entry) -> dict[str, Any]:
    report = entry.outcome['report']
    return {
        'entry': entry, 'start': start_of(entry),
        'verdict': words(report['verdict']) if report else 'error',
        'names': ', '.join(words(effect['name']) for effect in entry.effects),
        'stiffness': entry.corrected('stiffness'), 'damping': entry.corrected('damping'),
    }


def prepare_summary(fleet: Fleet) -> dict[str, Any]:
    """Return counts and findings."""
    verdicts = Counter(words(entry.report['verdict']) for entry in fleet.entries if entry.report)
    findings = [
        f'{one.group}: {words(one.family)} {"appears" if one.rises else "disappears"} from '
        f'recording {one.number} of the group on (number {one.entry.number} of all, '
        f'{one.entry.name})' for one in fleet.changes]
    for trend in trends(fleet.entries):
        if trend.significant:
            slope, low, high, _ = signed_percents(trend)
            findings.append(f'{trend.group}: {QUANTITIES[trend.quantity][0]} changes by {slope} % '
                            f'per recording (95 % interval {low} to {high})')
    findings += [f'{group} differs from the other groups in {", ".join(what)}'
                 for group, what in _different(fleet).items()]
    return {
        'recordings': len(fleet.entries), 'failed': len(fleet.failed),
        'refused': sum(entry.outcome['report'] is not None and entry.report is None
                       for entry in fleet.entries),
        'groups': len({entry.group for entry in fleet.entries}),
        'verdicts': verdicts.most_common(), 'findings': findings,
        'version': fleet.settings.version,
    }


def _different(fleet: Fleet) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for one in differences(fleet.entries):
        what = QUANTITIES[one.what][0] if one.is_quantity else words(one.what)
        found.setdefault(one.group, []).append(what)
    return found


def prepare_trends(fleet: Fleet) -> dict[str, Any] | None:
    """Return a row and a figure for each group and quantity; None without any value."""
    found = trends(fleet.entries)
    if not found:
        return None
    named = {entry.group: [] for entry in fleet.entries}  # type: dict[str, list[bool]]
    for entry in fleet.entries:
        named[entry.group].append(bool(entry.families))
    return {
        'rows': [_trend_row(trend) for trend in found],
        'figures': [(f'{QUANTITIES[trend.quantity][0]} of {trend.group} over its recordings',
                     plot_trend(trend, named[trend.group])) for trend in found],
        'per_day': any(isfinite(trend.per_day) for trend in found),
    }


def _trend_row(trend: Trend) -> dict[str, Any]:
    symbol, unit = QUANTITIES[trend.quantity]
    slope, low, high, per_day = signed_percents(trend)
    return {
        'group': trend.group, 'symbol': f'{symbol} [{unit}]', 'count': len(trend.values),
        'first': trend.intercept + trend.slope * float(trend.numbers[0]),
        'slope': slope, 'interval': f'{low} to {high}' if slope else '', 'per_day': per_day,
        'significant': trend.significant,
    }


def as_html(fleet: Fleet) -> str:
    """Build the page."""
    environment = diagnosis_page.environment(__package__, 'contact_estimation.diagnosis.report')
    return environment.get_template('fleet.html').render(
        verdict='fleet', title=f'{len(fleet.entries)} recordings',
        summary=prepare_summary(fleet), changes=prepare_changes(fleet),
        trends=prepare_trends(fleet), differences=prepare_differences(fleet),
        names=prepare_names(fleet), pooled=prepare_pooled(fleet), errors=prepare_errors(fleet),
        recordings=prepare_recordings(fleet))
