# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The recordings of an archive, with a group each: files, folders, patterns, rosbag2 folders."""

from glob import glob, has_magic
import os
from pathlib import Path
import re
from typing import Iterator, NamedTuple, Sequence

from ..exceptions import ParameterRangeError, RecordingError
from ..recordings.bag_folder import natural_order
from ..recordings.table_file import is_table
from ..texts import printable

ONE_GROUP = 'all'
"""Name of the only group without a pattern."""

_SUFFIXES = ('.mcap', '.db3')
_BAG = 'metadata.yaml'


class FoundRecording(NamedTuple):
    """A recording of the archive."""

    name: str  # its path as found, below the path that was given; bytes that are not UTF-8 escaped
    path: str  # absolute: workers have a working directory of their own
    group: str  # the robot, wall or day that it belongs to


def find_recordings(paths: Sequence[str], group_by: str | None = None) -> list[FoundRecording]:
    """Find the recordings at the given paths."""
    pattern = None if group_by is None else _compiled(group_by)
    found: dict[str, FoundRecording] = {}
    for given in paths:
        for path in _below(given):
            real = os.path.realpath(path)
            if real not in found:
                name = printable(path.as_posix())
                found[real] = FoundRecording(name, os.path.abspath(path), _group(name, pattern))
    return sorted(found.values(), key=lambda one: natural_order(one.name))


def skipped_files(paths: Sequence[str]) -> list[str]:
    """Find the logs in given folders of a kind that is not searched for, and pipes."""
    return [printable(file.as_posix()) for given in paths if os.path.isdir(given)
            for file in sorted(Path(given).rglob('*')) if _is_log(file) and file.exists()
            and not file.is_dir() and not _is_looked_at(file)]


def _is_log(path: Path) -> bool:
    return path.suffix in (*_SUFFIXES, '.bag') or is_table(path)


def _compiled(group_by: str) -> re.Pattern[str]:
    try:
        pattern = re.compile(group_by)
    except re.error as error:
        raise ParameterRangeError(
            f'--group-by must be a regular expression, got {group_by!r}: {error}; example: '
            "'(robot_[a-z]+)/'") from error
    if not pattern.groups:
        raise ParameterRangeError(
            f'--group-by must have a group in parentheses, got {group_by!r}; put the part of the '
            "path that names the robot in parentheses, such as '(robot_[a-z]+)/'")
    return pattern


def _group(name: str, pattern: re.Pattern[str] | None) -> str:
    if pattern is None:
        return ONE_GROUP
    match = pattern.search(name) or pattern.search(f'{name}/')  # a folder that cannot be read
    parts = [part for part in match.groups() if part] if match else []
    if not parts:
        raise ParameterRangeError(
            f'--group-by {pattern.pattern!r} must match every path, but not {name}; extend the '
            'pattern or give fewer recordings')
    return '/'.join(parts)


def _below(given: str) -> Iterator[Path]:
    """Yield the recordings that a path, or a pattern that is no path, stands for."""
    if os.path.exists(given):
        recordings = list(_recordings_at(Path(given)))
    elif has_magic(given):
        matches = sorted(glob(given, recursive=True), key=natural_order)
        recordings = [one for match in matches for one in _recordings_at(Path(match), True)]
    else:
        raise RecordingError(
            f'{given} does not exist; give recordings, folders of recordings or a pattern')
    if not recordings:
        raise RecordingError(
            f'no recording at {given}: expected {" or ".join(_SUFFIXES)} files or rosbag2 '
            'folders; give the folder that holds them')
    yield from recordings


def _recordings_at(path: Path, of_pattern: bool = False) -> Iterator[Path]:
    """Yield a regular file as it is, and the recordings of a folder, each place once."""
    if not os.path.isdir(path):
        # a file that is named is meant
        if os.path.isfile(path) and (path.suffix in _SUFFIXES or is_table(path) or not of_pattern):
            yield path
        return
    # Links come last: a recording has the name of its own place, and a loop ends.
    places, links = [path], list[Path]()
    seen: set[str] = set()
    while places or links:
        place = places.pop() if places else links.pop()
        real = os.path.realpath(place)
        if real in seen:
            continue
        seen.add(real)
        entries = _entries(place)
        if entries is None:
            yield place
            continue
        for entry in entries:
            (links if os.path.islink(entry) else places).append(entry)


def _entries(place: Path) -> list[Path] | None:
    """Return what of a folder is looked at; None for a recording, or what cannot be read."""
    if not os.path.isdir(place) or os.path.exists(place / _BAG):
        return None
    try:
        names = sorted(os.listdir(place), key=natural_order, reverse=True)
    except OSError:
        return None  # its row has the error
    return [place / name for name in names
            if not name.startswith('.') and _is_looked_at(place / name)]


def _is_looked_at(path: Path) -> bool:
    """Return whether a path is a folder or a file of a recording; a broken link is, too."""
    if os.path.isdir(path):
        return True
    regular = os.path.isfile(path) or not os.path.exists(path)  # a pipe would be read for ever
    return path.suffix in _SUFFIXES and regular
