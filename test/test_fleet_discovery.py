# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Which recordings `fleet` finds, and what its page finds in them."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path

from contact_estimation.exceptions import ParameterRangeError, RecordingError
from contact_estimation.fleet.discovery import find_recordings, skipped_files
from contact_estimation.fleet.findings import changes, differences, trends
from contact_estimation.fleet.one_recording import Settings
from contact_estimation.fleet.run import pools
from contact_estimation.fleet.table import in_time
from contact_estimation.plant.plant_parameters import PlantParameters
from fleet_entries import archive, group_of, report
import numpy as np
import pytest


@pytest.fixture
def robots(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Fill the working directory with recordings of two robots."""
    for name in ('robot_a/run_9.mcap', 'robot_a/run_10.mcap', 'robot_b/bag/bag_0.mcap',
                 'robot_b/bag/metadata.yaml', 'robot_b/notes.txt', '.hidden/run.mcap'):
        file = tmp_path / 'archive' / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def names(*paths: str, group_by: str | None = None) -> list[str]:
    return [one.name for one in find_recordings(paths, group_by)]


def test_a_folder_stands_for_its_files_and_bags_in_natural_order(robots: Path) -> None:
    assert names('archive') == [
        'archive/robot_a/run_9.mcap', 'archive/robot_a/run_10.mcap', 'archive/robot_b/bag']


def test_patterns_and_files_are_found_once(robots: Path) -> None:
    assert names('archive/**/run_*', 'archive/robot_a/run_9.mcap') == [
        'archive/robot_a/run_9.mcap', 'archive/robot_a/run_10.mcap']


def test_groups_are_named_by_the_pattern(robots: Path) -> None:
    found = find_recordings(['archive'], '(robot_[a-z])/')
    assert [one.group for one in found] == ['robot_a', 'robot_a', 'robot_b']


@pytest.mark.parametrize('pattern, text', [
    ('(', 'must be a regular expression'), ('robot', 'must have a group in parentheses'),
    ('(robot_a)', 'must match every path, but not archive/robot_b/bag'),
])
def test_an_unusable_pattern_is_refused(robots: Path, pattern: str, text: str) -> None:
    with pytest.raises(ParameterRangeError, match=text):
        find_recordings(['archive'], pattern)


@pytest.mark.parametrize('path, text', [
    ('nowhere', 'nowhere does not exist'), ('archive/*.db3', 'no recording at'),
    ('empty', 'no recording at empty'),
])
def test_a_path_without_recordings_is_refused(robots: Path, path: str, text: str) -> None:
    (robots / 'empty').mkdir()
    with pytest.raises(RecordingError, match=text):
        find_recordings([path])


def test_key_depends_on_recording_model_options_and_version() -> None:
    given = Settings.of(PlantParameters())
    others = [Settings.of(PlantParameters(seed=1)), Settings.of(PlantParameters(), seed=1),
              Settings.of(PlantParameters(), version='0.0.0')]
    keys = {settings.key('recording', 'a') for settings in (given, *others)}
    assert len(keys | {given.key('recording', 'b')}) == 5
    assert Settings.of(PlantParameters()).key('recording', 'a') in keys


def test_tables_and_ros_1_bags_of_a_folder_are_told_and_tables_read_where_named(
    tmp_path: Path
) -> None:
    for name in ('a.mcap', 'b.csv', 'c.bag', 'notes.md'):
        (tmp_path / name).write_bytes(b'')
    assert [Path(one.name).name for one in find_recordings([str(tmp_path)])] == ['a.mcap']
    assert [Path(one).name for one in skipped_files([str(tmp_path)])] == ['b.csv', 'c.bag']
    named = find_recordings([str(tmp_path / '*')])
    assert [Path(one.name).name for one in named] == ['a.mcap', 'b.csv']


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


def test_copies_count_once_in_pools_changes_trends_and_differences() -> None:
    worn = group_of('a', [report(4800.0 - 60.0 * k, ['coulomb_friction'] * (k > 2))
                          for k in range(5)])
    copies = [replace(entry, name=f'{entry.name}_{n}') for entry in worn for n in range(4)]
    entries = in_time([*copies, *group_of('b', [report()] * 3)])
    assert [len(pool.members) for pool in pools(entries, [], 10)] == [5, 3]
    assert not changes(entries) and not differences(entries)
    assert all(np.isnan(trend.slope) and len(trend.values) < 6 for trend in trends(entries))
