# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Tables as recordings: rows become messages, messages become rows."""

import csv
from functools import partial
from math import isnan, nan, prod
from pathlib import Path
from typing import Any, Callable, Collection, Iterable, Iterator, Mapping, NamedTuple, Sequence
from warnings import catch_warnings, simplefilter

import numpy as np
from numpy.typing import NDArray

from .bag_folder import is_recording
from .chunk_reader import RecordedMessage
from .columns import columns_of_signals, is_effort, signals_of_columns
from .encoding import encode_arm, WrenchEncoder
from .mcap_records import Summary
from .source import canonical, RecordingSource, TYPES
from .text_table import Columns, is_text, read_text
from ..exceptions import MissingPackageError, RecordingError

MOST_CELLS = 1 << 26
"""Numbers of a compressed table: 0.5 GiB, with what is made of them 2 GiB."""


def is_table(path: Path) -> bool:
    """Return whether a file is a table, by its suffix."""
    return path.suffix.lower() in _READERS


def reads_as_table(path: Path) -> bool:
    """Return whether a recording is a table, by its suffix, or else by its being text."""
    if is_table(path) or not path.is_file() or is_recording(path):
        return is_table(path)
    return is_text(path)


def require_a_table(
    paths: Iterable[str | Path], columns: Mapping[str, str], units: Sequence[str]
) -> None:
    """Refuse columns and units where no recording is a table; a missing one is another error."""
    recordings = [Path(path) for path in paths]
    if (columns or units) and recordings and not any(
            reads_as_table(path) or not path.exists() for path in recordings):
        option = '--columns' if columns else '--units'
        raise RecordingError(
            f'{option} is for tables, such as CSV, Parquet or MAT, but {recordings[0]} is none; '
            'choose the topics of a bag with --topic, the component of the force with --axis, and '
            'a field of its messages with --wrench-field')


def read_columns(path: Path) -> Columns:
    """
    Read all columns of numbers.

    Returns columns (N,): by name, in file order; NaN where a cell is empty. Columns without a
    header are named '1', '2',
    """
    try:
        columns = _READERS.get(path.suffix.lower(), read_text)(path)
    except (OSError, csv.Error) as error:
        reason = getattr(error, 'strerror', None) or error
        raise RecordingError(f'cannot read table {path}: {reason}; check the file') from error
    if not columns or not min(map(len, columns.values())):
        raise RecordingError(
            f'table {path} must have rows of numbers, got {"none" if columns else columns}; '
            'give a table with one sample a row, such as: t,Fz,z')
    return columns


def _parquet(path: Path) -> Columns:
    try:
        from pyarrow import ArrowException, parquet, types
    except ImportError as error:
        raise MissingPackageError.of('pyarrow', f'reading {path}') from error
    try:
        with parquet.ParquetFile(path) as file:
            leaves = [*map(file.metadata.schema.column, range(file.metadata.num_columns))]
            names = [leaf.path for leaf in leaves]
            numbers = [leaf.path for leaf in leaves if not leaf.max_repetition_level and (
                # A text or a list may expand to any size.
                'BYTE_ARRAY' not in leaf.physical_type
                or leaf.logical_type.type in ('DECIMAL', 'FLOAT16'))]
            _require_size(path, file.metadata.num_rows * len(numbers))
            table = file.read(columns=numbers)
        while any(map(types.is_struct, table.schema.types)):
            table = table.flatten()
        columns = dict(zip(table.column_names, table.columns))
        del table
        for name, column in columns.items():
            if types.is_decimal(column.type):
                columns[name] = column.cast('float64')
            elif types.is_time(column.type):
                columns[name] = column.cast('time64[ns]').cast('int64').cast('duration[ns]')
        found = _of_arrays({name: columns.pop(name).to_numpy() for name in list(columns)})
        found.left_out += [name for name in names if name not in numbers]
        return found
    except (ArrowException, ValueError) as error:
        raise RecordingError(
            f'pyarrow cannot read table {path}: {error}; write it again') from error


def _mat(path: Path) -> Columns:
    from scipy.io import loadmat, whosmat

    try:
        with catch_warnings():
            simplefilter('ignore')  # of sizes in damaged files
            try:
                shapes = [shape for _, shape, _ in whosmat(path)]
            except TypeError as error:  # an object has no shape
                raise RecordingError(
                    f'table {path} holds an object of a class, which only MATLAB reads; save its '
                    "values: s = struct(object); save('values.mat', '-struct', 's')") from error
            _require_size(path, sum(map(prod, shapes)))
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
        inside, within = value, f'{prefix}{name}.'
        if isinstance(value, list) or getattr(value, 'dtype', None) == object:  # of structs
            each = value if isinstance(value, list) else value.ravel()
            inside, within = {f'{name}({k})': one for k, one in enumerate(each, 1)}, prefix
        if isinstance(inside, dict):
            inner = _of_arrays(inside, within)
            found.update(inner)
            found.left_out += inner.left_out
            continue
        array = np.squeeze(np.asarray(value))
        if array.dtype.kind in 'mM':
            array = array.astype(f'{array.dtype.kind}8[ns]').astype(np.int64)
            name = f'{name}_ns'
        if array.dtype.kind in 'iufb' and array.ndim in (1, 2):
            array = array.T if array.ndim == 2 and len(array) < len(array.T) else array
            own = np.atleast_2d(array.T)
            names = [name] if array.ndim == 1 else [f'{name}_{k}' for k in range(1, len(own) + 1)]
            found.update(zip((prefix + each for each in names), own))
        else:
            found.left_out.append(prefix + name)
    lengths = [len(column) for column in found.values()]
    most = max(set(lengths), key=lengths.count, default=0)
    columns = Columns(
        (name, column.astype(np.int64 if column.dtype.kind in 'iu' else np.float64, copy=False))
        for name, column in found.items() if len(column) == most)
    columns.left_out = found.left_out + [name for name in found if name not in columns]
    return columns


_READERS: dict[str, Callable[[Path], Columns]] = {
    **dict.fromkeys(('.csv', '.tsv', '.txt', '.dat'), read_text), '.parquet': _parquet,
    '.mat': _mat,
}


_BATCH = 5000  # rows
FORCES = tuple(f'wrench.{kind}.{axis}' for kind in ('force', 'torque') for axis in 'xyz')
RATES = {'joint': ('velocity', 'effort'), 'reference': ('velocity', 'acceleration', 'effort')}
Rows = NDArray[np.float64]


class TableFile:
    """Read a table with the interface of `McapFile`; columns: column of each signal."""

    hidden = damaged = 0
    definitions: Mapping[str, str] = {}

    def __init__(self, path: Path, source: RecordingSource) -> None:
        self.path, self.summary, self.position = path, Summary(whole=True), 0
        columns, where = read_columns(path), f'table {path}'
        stamp_ns, signals = signals_of_columns(columns, source.columns, source.units, where)
        self.columns = columns_of_signals(columns, source.columns, source.units, where)
        for key, column in self.columns.items():
            if odd := columns.odd.get(column.removeprefix('-')):
                self.columns[key] += f' ({odd[0]} cells hold no number, the first {odd[1][:40]!r})'
        order = np.argsort(stamp_ns, kind='stable')
        again = np.diff(stamp_ns[order], prepend=-1) == 0
        for values in signals.values():
            own = values[order[again]], values[order[np.flatnonzero(again) - 1]]
            again[again] = (own[0] == own[1]) | np.isnan(own).all(axis=0)
        if again.any():
            self.columns['t'] += f' ({again.sum()} rows are copies of others and are left out)'
        self._order = order[~again]
        self._stamp_ns = stamp_ns[self._order]
        self._topics = {getattr(source, name): (TYPES[name], own) for name, own in messages_of(
            signals, len(stamp_ns)).items()}
        self.size = max(1, len(self._order))

    def batches(self, wanted: Mapping[str, str] | None) -> Iterator[list[RecordedMessage]]:
        names = {topic: topic if wanted is None else wanted[canonical(topic)]
                 for topic in self._topics if wanted is None or canonical(topic) in wanted}
        for begin in range(0, len(self._stamp_ns), _BATCH):
            part = slice(begin, begin + _BATCH)
            self.position = min(begin + _BATCH, self.size)
            stamps_ns = self._stamp_ns[part].tolist()
            columns = [(name, own.encode, own.rows(self._order[part])) for name, own in (
                (name, self._topics[topic][1]) for topic, name in names.items())]
            yield [RecordedMessage(name, stamp_ns, encode(stamp_ns, rows[place]))
                   for place, stamp_ns in enumerate(stamps_ns) for name, encode, rows in columns
                   # A row may lack what is sampled at another rate.
                   if not isnan(rows[place][0])]

    def topics(self, asked: Collection[str] | None) -> dict[str, str]:
        """Return the type of each topic."""
        return {topic: type_name for topic, (type_name, _) in self._topics.items()}

    def metadata(self) -> dict[str, dict[str, str]]:
        """Return no records: a table has none."""
        return {}

    def time_span(self) -> tuple[int, int] | None:
        """Return the times of the first and the last row [ns]."""
        return int(self._stamp_ns[0]), int(self._stamp_ns[-1])


class Messages(NamedTuple):
    """The messages of a topic in columns, stacked when they are needed: a table may be large."""

    encode: Callable[[int, Sequence[float]], bytes]  # from stamp [ns] and row
    columns: Sequence[Rows]  # of shape (N,)
    whole: bool  # whether a row without one of its numbers is no message

    def rows(self, places: Any) -> list[list[float]]:
        """Return rows; one that begins with NaN is no message."""
        rows = np.array([column[places] for column in self.columns]).T
        if self.whole:
            rows[np.isnan(rows).any(axis=1), 0] = nan
        found: list[list[float]] = rows.tolist()
        return found


def messages_of(signals: Mapping[str, Rows], count: int) -> dict[str, Messages]:
    """
    Arrange signals as the messages of topics.

    signals (N,): by key, as of `signals_of_columns`
    count: n
    Returns messages, by name of the topic
    """
    found, zero, unknown = dict[str, Messages](), *(
        np.broadcast_to(value, count) for value in (0.0, nan))
    if any(key in signals for key in FORCES):
        wrenches = WrenchEncoder('')
        found['wrench'] = Messages(lambda stamp_ns, row: wrenches.encode(stamp_ns, *row),
                                   [signals.get(key, zero) for key in FORCES], whole=True)
    for topic, kind in (('joint_states', 'joint'), ('reference_trajectory', 'reference')):
        names = [key[len(kind) + 1:] for key in signals if key.startswith(f'{kind}.')
                 and not key.endswith(tuple('.' + rate for rate in RATES[kind]))]
        if names:
            efforts = any(map(is_effort, signals))
            rates = RATES[kind] if kind == 'reference' or efforts else ('velocity',)
            found[topic] = Messages(
                partial(_encode, names, topic),
                [signals.get(f'{kind}.{name}{rate}', unknown)
                 for rate in ('', *('.' + r for r in rates)) for name in names], whole=False)
    return found


def _encode(names: Sequence[str], topic: str, stamp_ns: int, row: Sequence[float]) -> bytes:
    """Encode a row of positions, followed by their rates."""
    count, is_point = len(names), topic == 'reference_trajectory'
    rows = [row[at:at + count] for at in range(0, len(row), count)]
    if not is_point and len(rows) < 3:
        rows.append(())  # no efforts
    return encode_arm(stamp_ns, names, *rows, point=is_point)
