# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What the fleet's page finds: order in time, trends, changes, differences."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

from contact_estimation.fleet.changes import changes
from contact_estimation.fleet.differences import differences
from contact_estimation.fleet.entry import in_time
from contact_estimation.fleet.pooling import pools
from contact_estimation.fleet.trends import trends
from fleet_entries import archive, group_of, report
import numpy as np
import pytest

RNG = np.random.default_rng(1)
STEADY = [report(value) for value in RNG.normal(4800.0, 5.0, 20)]
WORN = [report(4800.0 * 0.998**k + noise) for k, noise in enumerate(RNG.normal(0.0, 5.0, 20))]
FRICTION = [report(4800.0, ['coulomb_friction'] if k >= 12 else []) for k in range(20)]


def test_trend_is_the_median_of_all_slopes_in_pairs() -> None:
    trend = next(one for one in trends(archive(b=WORN)) if one.quantity == 'stiffness')
    points = list(zip(trend.numbers.tolist(), trend.values.tolist()))
    slopes = [(y2 - y1) / (x2 - x1) for (x1, y1), (x2, y2) in combinations(points, 2)]
    assert trend.slope == pytest.approx(np.median(slopes))
    assert trend.per_day == pytest.approx(trend.slope)  # a recording a day


def test_only_wear_is_a_significant_trend() -> None:
    found = trends(archive(a=STEADY, b=WORN))
    assert [(one.group, one.quantity) for one in found if one.significant] == [('b', 'stiffness')]
    wear = next(one for one in found if one.significant)
    assert wear.percent(wear.low) < -0.2 < wear.percent(wear.high) < 0.0


def test_change_is_found_at_the_first_recording_with_the_name() -> None:
    change, = changes(archive(a=STEADY, c=FRICTION))
    assert (change.group, change.family, change.number) == ('c', 'friction', 13)
    assert change.entry.name == 'c/run_12.mcap'
    assert (change.before, change.after) == ((0, 12), (8, 8))
    assert change.earliest == change.latest == 13


def test_only_the_group_that_is_different_differs() -> None:
    softer = [report(value) for value in RNG.normal(4700.0, 5.0, 20)]
    entries = archive(a=STEADY, b=STEADY[::-1], c=softer, d=FRICTION)
    found = [(one.group, one.what) for one in differences(entries)]
    assert found == [('c', 'stiffness'), ('d', 'friction')]


def test_what_single_recordings_do_not_resolve_is_no_trend_and_no_difference() -> None:
    # Deviations are 1.0: a step of 0.5 between groups and a drift of 0.5 in all are within them.
    level = [report(4800.0 + 1e-4 * k) for k in range(20)]
    drifting = [report(4800.5 + 0.5 * k / 19.0) for k in range(20)]
    entries = archive(a=level, b=drifting)
    assert not any(one.significant for one in trends(entries))
    assert differences(entries) == []


def test_copies_count_once_in_pools_changes_trends_and_differences() -> None:
    worn = group_of('a', [report(4800.0 - 60.0 * k, ['coulomb_friction'] * (k > 2))
                          for k in range(5)])
    copies = [replace(entry, name=f'{entry.name}_{n}') for entry in worn for n in range(4)]
    entries = in_time([*copies, *group_of('b', [report()] * 3)])
    assert [len(pool.members) for pool in pools(entries, [], 10)] == [5, 3]
    assert not changes(entries) and not differences(entries)
    assert all(np.isnan(trend.slope) and len(trend.values) < 6 for trend in trends(entries))
