# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Text with one sample a line: any delimiter, decimal mark and encoding of spreadsheets."""

from collections import Counter
import csv
from itertools import islice
from pathlib import Path
import re
from statistics import mode
from typing import Any, Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray


class Columns(dict[str, NDArray[Any]]):
    """
    Numbers by name, all of one length: int64 where a file has integers, else float64.

    odd: of columns that hold other texts, how many and the first of them
    left_out: names of what holds no numbers, or another number of them
    """

    def __init__(self, columns: Any = ()) -> None:
        super().__init__(columns)
        self.odd: dict[str, tuple[int, str]] = {}
        self.left_out: list[str] = []

    def __str__(self) -> str:
        found = ', '.join(map(repr, self)) or 'none'
        less = ', '.join(map(repr, self.left_out[:9]))
        return found + (f' (not {less}: texts, lists or another length)' if less else '')


_HEAD = 200  # lines in which the data begin
_DELIMITERS = (',', ';', '\t', '|', None)  # None: spaces
_UNIT = re.compile(r'[\[(][^\d\])][^\])]*[\])]|counts?|cycles?'
                   r'|(?![xyz]$)[a-zA-Zµμ°%/]{0,4}(?:[·*][a-zA-Z]{1,3})?')  # x is an axis
_LIKE_A_NUMBER = re.compile(r'\s*[+-]?\d*[.,][\d.,]*(?:[eE][+-]?\d+)?\s*')
_THOUSANDS = re.compile(r'\s*[+-]?[1-9]\d{0,2}(?:[.,]\d{3})+\s*')
_LIST = re.compile(r'\s*[\[(](\s*[-+.\d][^\[\]()]*)[\])]\s*')
_MISSING = {'', '-', '--', '?', 'na', 'n/a', '#n/a', 'null', 'none'}  # NaN is a number
_TIME = re.compile(
    # Of a date in another order than ISO's, the time of day counts; a time may have no hours.
    r'(?:(?:(\d{4}-\d\d-\d\d)|\d+[./-]\d+[./-]\d+)[T ]?(?=\d\d?:\d\d:))?(?:(\d\d?):(?=\d\d:))?'
    r'(\d\d?):(\d\d(?:[.,:]\d+)?) ?(?:([AP])\.?M\.?)?(?:Z|UTC|[+-]\d\d(?::?\d\d)?)?', re.I)


def read_text(path: Path) -> Columns:
    """Read text with any of the usual delimiters, lines before the header, and units."""
    with open(path, 'rb') as binary:
        encoding = _encoding(binary.read(1 << 16))
    with open(path, encoding=encoding, errors='replace', newline=None) as stream:
        head = list(islice(stream, _HEAD))
        delimiter, first = _begin_of_data(head)
        if first is None:
            return Columns()
        rows = list(_rows([line.lstrip('#% ') for line in head], delimiter))
        names = _names(rows[:first], rows[first:])
        mark = _decimal_mark([cell for row in rows[first:] for cell in row], delimiter)
        stream.seek(0)
        try:
            lines = stream if mark == '.' else _with_points(stream)
            table = np.loadtxt(lines, delimiter=delimiter, skiprows=first, ndmin=2, comments=None)
            columns = Columns(zip(names, table.T))
            for place, name in enumerate(names):
                if re.search('time|stamp|ns', name, re.I):
                    columns[name] = _integers(stream, delimiter, first, place, columns[name])
            return columns
        except ValueError:  # empty cells, texts, thousands
            stream.seek(0)
            return _cell_by_cell(islice(_rows(stream, delimiter), first, None), names, mark)


def is_text(path: Path) -> bool:
    """Return whether a file is text: it begins without control characters."""
    with open(path, 'rb') as binary:
        start = binary.read(1 << 12)
    return _encoding(start).startswith('utf-16') or not re.search(rb'[\x00-\x08\x0e-\x1f]', start)


def _encoding(start: bytes) -> str:
    """Tell the encodings that spreadsheets write; any byte is a character of the last."""
    if start[:2] in (b'\xff\xfe', b'\xfe\xff'):
        return 'utf-16'
    if b'\0' in start[:2]:  # ASCII in two bytes
        return 'utf-16-be' if start[:1] == b'\0' else 'utf-16-le'
    try:
        start[:max(len(start) - 3, start.rfind(b'\n'))].decode()  # may end within a character
    except UnicodeDecodeError:
        return 'latin-1'
    return 'utf-8-sig'


def _with_points(lines: Iterable[str]) -> Iterator[str]:
    """Yield lines with decimal points in place of commas, unless there are points already."""
    for line in lines:
        if '.' in line:
            raise ValueError('thousands')
        yield line.replace(',', '.')


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
    """Find the delimiter that makes most numbers, and the first row of numbers."""
    best: tuple[int, str | None, int | None] = 0, None, None
    for delimiter in _DELIMITERS:
        numbers = list(map(_numbers_in, _rows(head, delimiter)))
        most = max(numbers, default=0)
        if most > best[0]:
            first = numbers.index(most)
            while first and numbers[first - 1] > 0:  # rows with empty cells
                first -= 1
            best = most, delimiter, first
    return best[1], best[2]


def _numbers_in(row: Sequence[str]) -> int:
    """Count the numbers of a row that has mostly numbers, else 0."""
    filled = [cell for cell in row if cell.strip()]
    count = sum(bool(_LIST.fullmatch(cell)) or _number(cell, '.') is not None
                or _number(cell, ',') is not None for cell in filled)
    return count if 2 * count > len(filled) else 0


def _names(above: Sequence[list[str]], data: Sequence[list[str]]) -> list[str]:
    """Name the columns by the last rows above the data: groups, names, units."""
    count = mode(map(len, filter(None, data)))
    if all(len(row) != count for row in above):  # a delimiter ends each row, or some
        count = max(len(_without_end(row)) for row in data)
    above = [row if len(row) == count else _without_end(row) for row in above]
    rows = [[cell.strip('"\' ') for cell in row] for row in above if len(row) == count]
    rows = [row for row in rows if '=' not in row[0].split()]  # a setting: UNIT = gf,mm
    if not rows:
        return [str(place) for place in range(1, count + 1)]
    units = [''] * count
    if len(rows) > 1 and _are_units(*rows[-2:]):
        units = [cell if _UNIT.fullmatch(cell) else '' for cell in rows.pop()]
    names, groups = rows[-1], rows[-2] if len(rows) > 1 else [''] * count
    for place in range(1, count):  # a group is named above its first column
        groups[place] = groups[place] or groups[place - 1]
    counts = Counter(names)
    names = [f'{group} {name}'.strip() if not name or counts[name] > 1 else name
             for group, name in zip(groups, names)]
    counts = Counter(names)
    return [(f'column {place}: {name}' if name and counts[name] > 1
             else name or f'column {place}') + (f' [{unit.strip("[]()")}]' if unit else '')
            for place, (name, unit) in enumerate(zip(names, units), 1)]


def _without_end(row: list[str]) -> list[str]:
    """Return a row without the empty cells at its end."""
    return row[:max((place for place, cell in enumerate(row, 1) if cell.strip()), default=0)]


def _are_units(names: Sequence[str], row: Sequence[str]) -> bool:
    """Return whether a row holds the units of names."""
    cells = [(name, cell) for name, cell in zip(names, row) if cell and _number(cell, '.') is None]
    in_brackets = sum(cell.startswith(('[', '(')) for _, cell in cells)
    return 2 * in_brackets > len(cells) or all(
        name and (cell == name or _UNIT.fullmatch(cell)) for name, cell in cells)


def _cell_by_cell(rows: Iterator[list[str]], names: Sequence[str], mark: str) -> Columns:
    """Read rows of any cells; a list in a cell, such as [1, 2], makes columns NAME_0, NAME_1."""
    found, odd, sizes, periods = [], dict[str, tuple[int, str]](), None, dict[str, float]()
    for row in rows:
        if not any(cell.strip() for cell in row) or row[0].startswith(('#', '%')):
            continue
        lists = [(match := _LIST.fullmatch(cell)) and match[1].replace(',', ' ').split()
                 for cell in row[:len(names)]]
        if sizes is None:
            sizes = [0 if own is None else len(own) for own in lists]
            sizes += [0] * (len(names) - len(lists))
            periods = {name: 86400.0 if time[2] else 3600.0 for name, cell in zip(names, row)
                       if (time := _TIME.fullmatch(cell.strip())) and not time[1]}
        numbers: list[float | None] = []
        for name, cell, own, size in zip(names, row, lists, sizes):
            cells = (own or [])[:size] if size else [cell]
            numbers += [_number(one, mark) for one in cells] + [None] * (size - len(cells))
            if None in numbers[-len(cells):] and cell.strip().lower() not in _MISSING:
                count, text = odd.get(name, (0, cell))
                odd[name] = count + 1, text
        found.append(numbers)
    wide = [f'{name}_{k}' if size > 1 else name for name, size in zip(names, sizes or ())
            for k in range(size or 1)]
    table = np.full((len(found), len(wide)), np.nan)
    for values, numbers in zip(table, found):
        values[:len(numbers)] = [np.nan if number is None else number for number in numbers]
    columns = Columns(zip(wide, table.T))
    columns.odd = odd
    for name in periods.keys() & columns.keys():  # they begin again at midnight, or the hour
        known = np.isfinite(columns[name])
        columns[name][known] = np.unwrap(columns[name][known], period=periods[name])
    return columns


def _rows(lines: Iterable[str], delimiter: str | None) -> Iterator[list[str]]:
    if delimiter is None:
        return (line.split() for line in lines)
    return csv.reader(lines, delimiter=delimiter)


def _decimal_mark(cells: Sequence[str], delimiter: str | None) -> str:
    """Tell the decimal mark by the first number in which it cannot separate thousands."""
    numbers = list(filter(_LIKE_A_NUMBER.fullmatch, cells))
    for number in numbers:
        marks = re.findall('[.,]', number)
        if marks.count(marks[-1]) == 1 and (len(marks) > 1 or not _THOUSANDS.fullmatch(number)):
            return str(marks[-1])
    is_comma = delimiter != ',' and numbers and not any('.' in number for number in numbers)
    return ',' if is_comma else '.'


def _number(cell: str, mark: str) -> float | None:
    """Return the number of a cell, or the seconds of a date and time in ISO 8601."""
    try:
        if mark == '.' or '.' not in cell:
            return float(cell.replace(mark, '.'))
    except ValueError:
        pass
    text = cell.strip().replace('\u2212', '-')  # the minus of typesetters
    if ',' in text and '.' in text:
        mark = max(',.', key=text.rfind)
    separators = ",\u00a0\u202f '’" if mark == '.' else ".\u00a0\u202f '’"
    text = re.sub(rf'(?<=\d)(?<!^0)(?<!^-0)[{separators}](?=\d{{3}}(?!\d))', '', text)
    text = text.replace(',', '.')
    try:
        return float(re.sub(r'(?<=[\d.])[dD](?=[+-]?\d)', 'e', text))  # Fortran's exponent
    except ValueError:
        return _seconds(cell.strip())


def _seconds(text: str) -> float | None:
    """Return the seconds of a time, of a day if it has a date."""
    match = _TIME.fullmatch(text)
    if not match:
        return None
    day, hour, minute, second, half = match.groups()
    if hour is None and second.isdigit():  # hours and minutes
        return None
    hours = int(hour or 0) % 12 + 12 * (half in 'Pp') if half else int(hour or 0)
    try:
        date = np.datetime64(day or '1970-01-01', 'D').astype(int)
    except ValueError:
        return None
    known = hours < 24 and int(minute) < 60
    seconds = float(re.sub('[,:]', '.', second))
    return 86400.0 * date + 3600.0 * hours + 60.0 * int(minute) + seconds if known else None
