# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""Tables of numbers by the names of their columns: CSV, Parquet and MAT files."""

from __future__ import annotations

import csv
from itertools import islice
from math import prod
from pathlib import Path
import re
from typing import Any, Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ..exceptions import MissingPackageError, RecordingError
from ..texts import LFS_POINTER

Columns = dict[str, NDArray[Any]]
"""Numbers by name, all of one length: int64 where a file has integers, else float64."""

_HEAD = 200  # lines in which the data begin
_DELIMITERS = (',', ';', '\t', None)  # None: spaces
_THOUSANDS = re.compile(r'[+-]?\d{1,3}(,\d{3})+')
_UNIT = re.compile(r'[\[(]?[a-zA-Z%/]{0,4}[\])]?')
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
        if not path.is_file():
            raise RecordingError(f'table {path} must be a regular file; save it to a file first')
        columns = _READERS[path.suffix.lower()](path)
    except (OSError, csv.Error) as error:
        reason = getattr(error, 'strerror', None) or error
        raise RecordingError(f'cannot read table {path}: {reason}; check the file') from error
    if not columns or not min(map(len, columns.values())):
        raise RecordingError(
            f'table {path} must have rows of numbers, got none; give a table with one sample a '
            'row, such as: t,Fz,z')
    return columns


def _csv(path: Path) -> Columns:
    """Read text with any of the usual delimiters, lines before the header, and units."""
    with open(path, encoding='utf-8-sig', errors='surrogateescape', newline='') as stream:
        head = list(islice(stream, _HEAD))
        if head and head[0].startswith(LFS_POINTER):
            raise RecordingError(
                f'{path} is a Git LFS pointer, expected the table itself; get it with: git lfs '
                'pull')
        delimiter, first = _begin_of_data(head)
        if first is None:
            return {}
        names = _names(head[:first], delimiter, len(_cells(head[first], delimiter)))
        stream.seek(0)
        try:
            table = np.loadtxt(stream, delimiter=delimiter, skiprows=first, ndmin=2, comments=None)
            columns: Columns = dict(zip(names, table.T))
            for place, name in enumerate(names):
                if re.search('time|stamp|ns', name, re.I):
                    columns[name] = _integers(stream, delimiter, first, place, columns[name])
            return columns
        except ValueError:  # empty cells, texts, decimal commas
            stream.seek(0)
            return _cell_by_cell(islice(stream, first, None), delimiter, names)


def _integers(
    stream: Any, delimiter: str | None, first: int, place: int, column: NDArray[Any]
) -> NDArray[Any]:
    """Return a column exactly where it has integers: stamps in ns need more than float64."""
    if np.any(column != np.rint(column)):
        return column
    stream.seek(0)
    try:
        return np.loadtxt(stream, np.int64, delimiter=delimiter, ndmin=1, skiprows=first,
                          usecols=place, comments=None)
    except (ValueError, OverflowError):  # 1.0
        return column


def _begin_of_data(head: Sequence[str]) -> tuple[str | None, int | None]:
    """Find the delimiter that makes most numbers, and the first line of numbers."""
    best: tuple[int, str | None, int | None] = 0, None, None
    for delimiter in _DELIMITERS:
        numbers = [_numbers_in(line, delimiter) for line in head]
        most = max(numbers, default=0)
        if most > best[0]:
            first = numbers.index(most)
            while first and numbers[first - 1] > 0:  # rows with empty cells
                first -= 1
            best = most, delimiter, first
    return best[1], best[2]


def _numbers_in(line: str, delimiter: str | None) -> int:
    """Count the numbers of a line that has mostly numbers, else 0."""
    filled = [cell for cell in _cells(line, delimiter) if cell.strip()]
    count = sum(_number(cell, delimiter) is not None for cell in filled)
    return count if 2 * count > len(filled) else 0


def _names(above: Sequence[str], delimiter: str | None, count: int) -> list[str]:
    """Name the columns by the last lines above the data, of which the last may hold units."""
    rows = [[cell.strip('"\' ') for cell in _cells(line.lstrip('#% '), delimiter)]
            for line in above if line.strip()]
    rows = [row for row in rows if len(row) == count]
    names = [str(place) for place in range(1, count + 1)]
    if rows:
        names = rows[-1]
        if len(rows) > 1 and all(map(_UNIT.fullmatch, rows[-1])):
            names = [f'{name} [{unit.strip("[]()")}]' for name, unit in zip(*rows[-2:])]
    seen: dict[str, int] = {}
    for place, name in enumerate(names):
        seen[name] = seen.get(name, 0) + 1
        names[place] = name if name and seen[name] == 1 else f'{name or "column"} {place + 1}'
    return names


def _cell_by_cell(lines: Iterator[str], delimiter: str | None, names: Sequence[str]) -> Columns:
    rows = []
    for line in lines:
        cells = _cells(line, delimiter)
        if any(cell.strip() for cell in cells):
            numbers = [_number(cell, delimiter) for cell in cells[:len(names)]]
            rows.append([np.nan if one is None else one for one in numbers]
                        + [np.nan] * (len(names) - len(numbers)))
    return dict(zip(names, np.array(rows, np.float64).reshape(-1, len(names)).T))


def _cells(line: str, delimiter: str | None) -> list[str]:
    if delimiter is None:
        return line.split()
    return next(csv.reader([line.rstrip('\r\n')], delimiter=delimiter), [])


def _number(cell: str, delimiter: str | None) -> float | None:
    """Return the number of a cell, with a point or comma for decimals, or for thousands."""
    text = cell.strip()
    if ',' in text and '.' in text:  # the first of the two stands for thousands
        text = text.replace(',' if text.rfind(',') < text.rfind('.') else '.', '')
    elif delimiter == ',' and _THOUSANDS.fullmatch(text):
        text = text.replace(',', '')
    try:
        return float(text.replace(',', '.'))
    except ValueError:
        return None


def _parquet(path: Path) -> Columns:
    try:
        from pyarrow import ArrowException, parquet
    except ImportError as error:
        raise MissingPackageError.of('pyarrow', f'reading {path}') from error
    try:
        metadata = parquet.read_metadata(path)
        _require_size(path, metadata.num_rows * metadata.num_columns)
        table = parquet.read_table(path).flatten()
        return _of_arrays({name: column.to_numpy()
                           for name, column in zip(table.column_names, table.columns)})
    except (ArrowException, ValueError) as error:
        raise RecordingError(
            f'pyarrow cannot read table {path}: {error}; write it again') from error


def _mat(path: Path) -> Columns:
    from scipy.io import loadmat, whosmat

    try:
        _require_size(path, sum(prod(shape) for _, shape, _ in whosmat(path)))
        return _of_arrays(loadmat(path, simplify_cells=True))
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
    found: Columns = {}
    for name, value in arrays.items():
        if isinstance(value, dict):
            found.update(_of_arrays(value, f'{prefix}{name}.'))
            continue
        array = np.squeeze(np.asarray(value))
        if array.dtype.kind == 'M':
            array = array.astype('datetime64[ns]').astype(np.int64)
            name = f'{name}_ns'
        if array.dtype.kind in 'iufb' and array.ndim in (1, 2) and not name.startswith('__'):
            array = array.T if array.ndim == 2 and len(array) < len(array.T) else array
            own = array.reshape(len(array), -1).T
            names = [name] if array.ndim == 1 else [f'{name}_{k}' for k in range(1, len(own) + 1)]
            found.update(zip((prefix + each for each in names), own))
    lengths = [len(column) for column in found.values()]
    most = max(set(lengths), key=lengths.count, default=0)
    return {name: column.astype(np.int64 if column.dtype.kind in 'iu' else np.float64)
            for name, column in found.items() if len(column) == most}


_READERS: dict[str, Callable[[Path], Columns]] = {
    '.csv': _csv, '.tsv': _csv, '.txt': _csv, '.dat': _csv, '.parquet': _parquet, '.mat': _mat,
}
