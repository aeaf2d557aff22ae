# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Tables of numbers by the names of their columns: CSV, Parquet and MAT files."""

from __future__ import annotations

import csv
from math import prod
from pathlib import Path
from typing import Any, Callable
from warnings import catch_warnings, simplefilter

import numpy as np

from .text_table import Columns, read_text
from ..exceptions import MissingPackageError, RecordingError

MOST_CELLS = 1 << 28
"""Numbers of a compressed table; 2 GiB in memory."""


def is_table(path: Path) -> bool:
    """Return whether a file is a table, by its suffix."""
    return path.suffix.lower() in _READERS


def read_columns(path: Path) -> Columns:
    """
    Read all columns of numbers.

    Returns columns (N,): by name, in file order; NaN where a cell is empty. Columns without a
    header are named '1', '2',
    """
    try:
        columns = _READERS[path.suffix.lower()](path)
    except (OSError, csv.Error) as error:
        reason = getattr(error, 'strerror', None) or error
        raise RecordingError(f'cannot read table {path}: {reason}; check the file') from error
    if not columns or not min(map(len, columns.values())):
        raise RecordingError(
            f'table {path} must have rows of numbers, got none; give a table with one sample a '
            'row, such as: t,Fz,z')
    return columns


def _parquet(path: Path) -> Columns:
    try:
        from pyarrow import ArrowException, parquet, types
    except ImportError as error:
        raise MissingPackageError.of('pyarrow', f'reading {path}') from error
    try:
        metadata = parquet.read_metadata(path)
        _require_size(path, metadata.num_rows * metadata.num_columns)
        table = parquet.read_table(path)
        while any(map(types.is_struct, table.schema.types)):
            table = table.flatten()
        return _of_arrays({name: column.to_numpy()
                           for name, column in zip(table.column_names, table.columns)})
    except (ArrowException, ValueError) as error:
        raise RecordingError(
            f'pyarrow cannot read table {path}: {error}; write it again') from error


def _mat(path: Path) -> Columns:
    from scipy.io import loadmat, whosmat

    try:
        with catch_warnings():
            simplefilter('ignore')  # of sizes in damaged files
            _require_size(path, sum(prod(shape) for _, shape, _ in whosmat(path)))
            found = loadmat(path, simplify_cells=True)
        return _of_arrays({name: value for name, value in found.items()
                           if not name.startswith('__')})
    except NotImplementedError as error:  # HDF5
        raise RecordingError(
            f"table {path} is a MAT file of version 7.3; save it with save(..., '-v7'), or as CSV "
            'by writetable') from error
    except (OSError, RecordingError):
        raise
    except Exception as error:  # of damaged files scipy raises almost anything
        raise RecordingError(f'scipy cannot read table {path}: {error}; save it again') from error


def _require_size(path: Path, cells: int) -> None:
    if cells > MOST_CELLS:
        raise RecordingError(
            f'table {path} has {cells} cells, expected at most {MOST_CELLS}; split it, or keep '
            'the columns that are needed')


def _of_arrays(arrays: Any, prefix: str = '') -> Columns:
    """Return the columns of nested arrays, those of the most common length."""
    found = Columns()
    for name, value in arrays.items():
        if isinstance(value, dict):
            found.update(_of_arrays(value, f'{prefix}{name}.'))
            continue
        array = np.squeeze(np.asarray(value))
        if array.dtype.kind == 'M':
            array = array.astype('datetime64[ns]').astype(np.int64)
            name = f'{name}_ns'
        if array.dtype.kind in 'iufb' and array.ndim in (1, 2):
            array = array.T if array.ndim == 2 and len(array) < len(array.T) else array
            own = array.reshape(len(array), -1).T
            names = [name] if array.ndim == 1 else [f'{name}_{k}' for k in range(1, len(own) + 1)]
            found.update(zip((prefix + each for each in names), own))
    lengths = [len(column) for column in found.values()]
    most = max(set(lengths), key=lengths.count, default=0)
    return Columns((name, column.astype(np.int64 if column.dtype.kind in 'iu' else np.float64))
                   for name, column in found.items() if len(column) == most)


_READERS: dict[str, Callable[[Path], Columns]] = {
    **dict.fromkeys(('.csv', '.tsv', '.txt', '.dat'), read_text), '.parquet': _parquet,
    '.mat': _mat,
}
