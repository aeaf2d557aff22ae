# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The MCAP files of a recording."""

from __future__ import annotations

from pathlib import Path, PurePosixPath
import re
from typing import Any

from .bag_metadata import FILE_NAME
from ..exceptions import RecordingError
from ..texts import yaml_file

_SQLITE = b'SQLite format 3\0'


def recording_files(path: Path) -> list[Path]:
    """List the files of a recording in the order in which they were written."""
    if not path.exists():
        raise RecordingError(
            f'recording {path} does not exist; give an existing .mcap file or rosbag2 folder'
        )
    if not path.is_dir() and not path.is_file():
        raise RecordingError(
            f'{path} is a pipe or device, expected a regular file, which can be read more than '
            'once; save it to a file first'
        )
    if not path.is_dir():
        return [path]
    information = _information(path / FILE_NAME)
    if information is not None:
        return _listed_files(path, information)
    files = sorted(path.glob('*.mcap'), key=lambda file: natural_order(file.name))
    if len({re.sub(r'_\d+$', '', file.stem) for file in files}) > 1:
        raise RecordingError(
            f'folder {path} holds several recordings ({_content(path)}) and no metadata.yaml; '
            'expected one recording, whose files differ in a number at the end; give one of them'
        )
    if files:
        return files
    files = sorted(path.glob('*.db3'), key=lambda file: natural_order(file.name))
    if files:
        return files
    raise RecordingError(
        f'folder {path} holds no recording: expected metadata.yaml or *.mcap, '
        f'got {_content(path)}; give an .mcap file or a rosbag2 folder'
    )


def needs_rosbags(path: Path) -> bool:
    """Return whether a file of a recording is not MCAP but what the package rosbags reads."""
    if path.is_dir():
        return True
    try:
        with open(path, 'rb') as stream:
            return stream.read(len(_SQLITE)) == _SQLITE
    except OSError:
        return False


def _information(path: Path) -> dict[str, Any] | None:
    """Read metadata.yaml; None where it is missing or was cut short."""
    try:
        content = yaml_file(path)
        information = content['rosbag2_bagfile_information']
        return information if information['relative_file_paths'] else None
    except (OSError, ValueError, TypeError, KeyError):
        return None


def _listed_files(folder: Path, information: dict[str, Any]) -> list[Path]:
    """Return the files that metadata.yaml lists."""
    mode = str(information.get('compression_mode') or 'none').lower()
    if information.get('storage_identifier') == 'sqlite3' or mode != 'none':
        return [folder]
    # Old versions wrote the folder's name before that of the file.
    files = [folder / PurePosixPath(str(p)).name for p in information['relative_file_paths']]
    missing = [file.name for file in files if not file.exists()]
    if missing:
        raise RecordingError(
            f'recording {folder} lacks {", ".join(missing)}, which its {FILE_NAME} lists; '
            f'copy the whole folder, or remove {FILE_NAME} to read what is there'
        )
    return files


def natural_order(name: str) -> list[tuple[int, str]]:
    """Return a sorting key that puts bag_10.mcap after bag_9.mcap."""
    return [(int(part), '') if part.isdecimal() else (-1, part)
            for part in re.split(r'([0-9]+)', name)]


def _content(folder: Path) -> str:
    """List the first entries of a folder."""
    names = sorted(entry.name for entry in folder.iterdir())
    return ', '.join(names[:3]) + (' and more' if len(names) > 3 else '') or 'nothing'
