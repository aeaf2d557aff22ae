# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Whether a file belongs to a recording, and whether two recordings hold the same data."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

from .bag_folder import FILE_NAME

_SUFFIXES = ('.mcap', '.db3', '.zstd', '.bag')
_MAGIC = (b'\x89MCAP0\r\n', b'SQLite format 3', b'\x28\xb5\x2f\xfd')  # the last: Zstandard
_BLOCK = 1 << 20


def is_recording(file: Path) -> bool:
    """Return whether an existing file is a recording, or may be what is left of one."""
    real = file.resolve()
    if any(one.suffix.lower() in _SUFFIXES or one.name == FILE_NAME for one in (file, real)):
        return True
    with open(real, 'rb') as stream:
        return stream.read(16).startswith(_MAGIC)


def is_bag_folder(folder: Path) -> bool:
    """Return whether a folder is a rosbag2 recording."""
    try:
        return b'rosbag2_bagfile_information' in (folder / FILE_NAME).read_bytes()
    except OSError:
        return False


def share_data(first: str | Path, second: str | Path) -> bool:
    """Return whether two recordings have a storage file in common, or a copy of one."""
    if os.path.exists(first) and os.path.exists(second) and os.path.samefile(first, second):
        return True
    files = [_by_size(Path(path)) for path in (first, second)]
    return any({file_sha256(file) for file in files[0][size]}
               & {file_sha256(file) for file in files[1][size]}
               for size in files[0].keys() & files[1].keys())


def _by_size(path: Path) -> dict[int, list[Path]]:
    """Return the storage files of a recording by their size."""
    files = [path]
    if path.is_dir():
        files = [file for file in path.iterdir() if file.suffix.lower() in _SUFFIXES]
    sizes: dict[int, list[Path]] = {}
    for file in files:
        if file.is_file() and (size := file.stat().st_size):
            sizes.setdefault(size, []).append(file)
    return sizes


def file_sha256(file: Path) -> str:
    """Return the hash of a file, read block by block."""
    digest = hashlib.sha256()
    with open(file, 'rb') as stream:
        while block := stream.read(_BLOCK):
            digest.update(block)
    return digest.hexdigest()
