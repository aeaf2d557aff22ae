# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Which recordings `fleet` finds, and their groups."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from contact_estimation.exceptions import ParameterRangeError, RecordingError
from contact_estimation.fleet.discovery import find_recordings, passed_over
from contact_estimation.fleet.fingerprint import recording_sha256, Settings
from contact_estimation.plant.plant_parameters import PlantParameters
import pytest


@pytest.fixture
def archive(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
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


def test_a_folder_stands_for_its_files_and_bags_in_natural_order(archive: Path) -> None:
    assert names('archive') == [
        'archive/robot_a/run_9.mcap', 'archive/robot_a/run_10.mcap', 'archive/robot_b/bag']


def test_patterns_and_files_are_found_once(archive: Path) -> None:
    assert names('archive/**/run_*', 'archive/robot_a/run_9.mcap') == [
        'archive/robot_a/run_9.mcap', 'archive/robot_a/run_10.mcap']


def test_groups_are_named_by_the_pattern(archive: Path) -> None:
    found = find_recordings(['archive'], '(robot_[a-z])/')
    assert [one.group for one in found] == ['robot_a', 'robot_a', 'robot_b']


@pytest.mark.parametrize('pattern, text', [
    ('(', 'must be a regular expression'), ('robot', 'must have a group in parentheses'),
    ('(robot_a)', 'must match every path, but not archive/robot_b/bag'),
])
def test_an_unusable_pattern_is_refused(archive: Path, pattern: str, text: str) -> None:
    with pytest.raises(ParameterRangeError, match=text):
        find_recordings(['archive'], pattern)


@pytest.mark.parametrize('path, text', [
    ('nowhere', 'nowhere does not exist'), ('archive/*.db3', 'no recording at'),
    ('empty', 'no recording at empty'),
])
def test_a_path_without_recordings_is_refused(archive: Path, path: str, text: str) -> None:
    (archive / 'empty').mkdir()
    with pytest.raises(RecordingError, match=text):
        find_recordings([path])


def test_a_folder_that_cannot_be_read_is_found_with_its_error(
    archive: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def listdir(path: str | Path, listed: Any = os.listdir) -> list[str]:
        if Path(path).name == 'robot_a':
            raise PermissionError(13, 'Permission denied', str(path))
        return list(listed(path))

    monkeypatch.setattr(os, 'listdir', listdir)
    found = names('archive', group_by='(robot_[a-z])/')
    assert found == ['archive/robot_a', 'archive/robot_b/bag']
    with pytest.raises(PermissionError):
        recording_sha256('archive/robot_a')


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
    assert [Path(one).name for one in passed_over([str(tmp_path)])] == ['b.csv', 'c.bag']
    named = find_recordings([str(tmp_path / '*')])
    assert [Path(one.name).name for one in named] == ['a.mcap', 'b.csv']
