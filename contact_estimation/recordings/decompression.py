# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Decompressing chunks that may be damaged."""

from __future__ import annotations

import functools
import importlib
from typing import Any

from .mcap_format import ChunkHead
from ..exceptions import MissingPackageError

_LARGEST_CHUNK = 2**32


def decompress(data: bytes, head: ChunkHead) -> bytes | None:
    """
    Decompress the data of a chunk.

    Parameters
    ----------
    data : bytes
        As in the file.
    head : ChunkHead
        Description of the chunk.

    Returns
    -------
    records : bytes or None
        None if the data are damaged.

    Raises
    ------
    MissingPackageError
        If the package for this compression is not installed.

    """
    if head.size > _LARGEST_CHUNK or head.compression not in ('', 'zstd', 'lz4'):
        return None
    if not head.compression:
        return data
    decompressor = _zstd if head.compression == 'zstd' else _lz4
    try:
        return decompressor(data, head.size)
    except MissingPackageError:
        raise
    except Exception:  # each package has its own exceptions; damaged data can cause any of them
        return None


def _zstd(data: bytes, size: int) -> bytes | None:
    """Decompress a Zstandard frame."""
    package, decompressor = _zstd_decompressor()
    stated = package.get_frame_parameters(data).content_size
    # A damaged frame must not make the library reserve terabytes.
    if stated != size and stated != package.CONTENTSIZE_UNKNOWN:
        return None
    return decompressor.decompress(data, max_output_size=size)


def _lz4(data: bytes, size: int) -> bytes:
    """Decompress an LZ4 frame."""
    return _package('lz4.frame', 'lz4').decompress(data)


@functools.lru_cache(maxsize=None)
def _zstd_decompressor() -> tuple[Any, Any]:
    """Import zstandard and make one decompressor for all chunks."""
    package = _package('zstandard', 'zstandard')
    return package, package.ZstdDecompressor()


def _package(module: str, name: str) -> Any:
    """Import a decompressor when a file needs it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise MissingPackageError.of(name, 'reading this compressed recording') from error
