# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What was diagnosed and what is significant, in a few sentences."""

from __future__ import annotations

from collections import Counter
from typing import Any

from .wording import signed_percents, words
from ..findings import differences, QUANTITIES, Trend, trends
from ..run import Fleet


def prepare(fleet: Fleet) -> dict[str, Any]:
    """Return counts and findings."""
    verdicts = Counter(words(entry.report['verdict']) for entry in fleet.entries if entry.report)
    findings = [
        f'{change.group}: {words(change.family)} '
        f'{"appears" if _rises(change.before, change.after) else "disappears"} from recording '
        f'{change.number} of the group on (number {change.entry.number} of all, '
        f'{change.entry.name})'
        for change in fleet.changes
    ]
    findings += [_of_trend(trend) for trend in trends(fleet.entries) if trend.significant]
    findings += [
        f'{group} differs from the other groups in {", ".join(what)}'
        for group, what in _different(fleet).items()
    ]
    return {
        'recordings': len(fleet.entries), 'failed': len(fleet.failed),
        'refused': sum(entry.outcome['report'] is not None and entry.report is None
                       for entry in fleet.entries),
        'groups': len({entry.group for entry in fleet.entries}),
        'verdicts': verdicts.most_common(), 'findings': findings,
        'version': fleet.settings.version,
    }


def _of_trend(trend: Trend) -> str:
    slope, low, high, _ = signed_percents(trend)
    return (f'{trend.group}: {QUANTITIES[trend.quantity][0]} changes by {slope} % per recording '
            f'(95 % interval {low} to {high})')


def _rises(before: tuple[int, int], after: tuple[int, int]) -> bool:
    return before[0] * after[1] < after[0] * before[1]


def _different(fleet: Fleet) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for one in differences(fleet.entries):
        what = QUANTITIES[one.what][0] if one.is_quantity else words(one.what)
        found.setdefault(one.group, []).append(what)
    return found
