# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Texts that others wrote: read within stated limits, and escaped where they are printed."""

from contextlib import contextmanager
import json
import os
from pathlib import Path
import sys
from typing import Any, Iterable, Iterator, Sequence

import yaml

_FOREIGN = {
    b'version https://git-lfs': 'it is a Git LFS pointer; get the file with: git lfs pull',
    b'PK\3\4': 'it is a ZIP archive or a spreadsheet (.xlsx); unpack it, or save the sheet as CSV',
    b'\xd0\xcf\x11\xe0': 'it is a spreadsheet (.xls); save the sheet as CSV',
    b'\x1f\x8b': 'it is compressed (gzip); decompress it first',
    b'BZh': 'it is compressed (bzip2); decompress it first',
    b'\xfd7zXZ': 'it is compressed (xz); decompress it first',
    b'\x89HDF': 'it is HDF5; save its columns as CSV, or in MATLAB with -v7',
    b'\x93NUMPY': 'it is an array of NumPy; save it by numpy.savetxt, or use write_recording',
}
"""What begins a file that no reader takes, and what to do about it; rosbag2 writes zstd."""
MOST_BYTES = 1 << 20
"""Longest YAML file; parameter files hold some 20 kB."""
MOST_LEVELS = 50
"""Deepest nesting of YAML; parameter files have 5 levels."""
MOST_VALUES = 100_000
"""Values of a YAML file, as often as aliases repeat them."""

_MOST_PRINTED = 4000  # characters of a line


def printable(text: str) -> str:
    """Return a text as one line that any terminal shows as it is."""
    if not text.isprintable():
        text = text.encode('utf-8', 'surrogateescape').decode('utf-8', 'backslashreplace')
        text = ''.join(c if c.isprintable() else c.encode('unicode_escape').decode() for c in text)
    if len(text) > _MOST_PRINTED:
        half = _MOST_PRINTED // 2
        text = f'{text[:half]} ({len(text) - 2 * half} characters left out) {text[-half:]}'
    return text


def print_help(text: str) -> None:
    """Print a text of which the reader may want the beginning alone, as `| head` does."""
    try:
        print(text, flush=True)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for the last flush


def markdown_table(columns: Sequence[str], rows: Iterable[Iterable[Any]]) -> str:
    """Format cells as a Markdown table."""
    lines = [[' '.join(str(cell).split()).replace('|', '\\|') for cell in row]
             for row in (columns, *rows)]
    lines.insert(1, ['---'] * len(columns))
    return '\n'.join('| ' + ' | '.join(line) + ' |' for line in lines)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Name the file in an error, such as that of a full disk, which does not."""
    try:
        yield
    except OSError as error:
        error.filename = error.filename or str(path)
        raise


def write_whole(file: Path, data: bytes) -> None:
    """Write a file whole or not at all."""
    partial = file.with_name(file.name + '.partial')
    with writing(file), open(partial, 'wb') as stream:
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())
    os.replace(partial, file)


def require_content(path: Path) -> None:
    """Require a regular file that holds the data themselves, not compressed."""
    if not path.is_file() and path.exists():
        raise ValueError(
            'expected a regular file, got a folder, pipe or device; save it to a file first')
    with open(path, 'rb') as stream:
        start = stream.read(max(map(len, _FOREIGN)))
    for magic, text in _FOREIGN.items():
        if start.startswith(magic):
            raise ValueError(text)


def text_file(path: Path, most: int = 1 << 26) -> str:
    """Read a text of at most so many bytes."""
    require_content(path)
    with open(path, 'rb') as stream:
        data = stream.read(most + 1)
    if len(data) > most:
        raise ValueError(f'expected at most {most} bytes, got more')
    try:
        return data.decode('utf-8-sig')
    except UnicodeDecodeError as error:
        raise ValueError(f'expected text in UTF-8, got other data: {error.reason}') from error


def yaml_file(path: Path) -> Any:
    """Read a YAML file of plain data."""
    try:
        return yaml.load(text_file(path, MOST_BYTES), _BoundedLoader)
    except yaml.YAMLError as error:
        text = str(error).replace('in "<unicode string>", ', 'in ')
        raise ValueError(' '.join(text.split())) from error


def json_content(text: str) -> Any:
    """Read JSON of plain data."""
    try:
        return json.loads(text)
    except RecursionError as error:
        raise ValueError('its brackets are nested too deep') from error
    except ValueError as error:
        raise ValueError(str(error).partition(';')[0]) from error  # no advice on Python


class _BoundedLoader(yaml.SafeLoader):
    """Refuse what takes unbounded time or memory, and name values that Python cannot hold."""

    def __init__(self, stream: Any) -> None:
        super().__init__(stream)
        self._level, self._count = 0, 0
        self._sizes = dict[int, int]()

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Count levels, and values as often as aliases repeat them."""
        event: Any = self.peek_event()
        before, self._count = self._count, self._count + 1
        if self._level == MOST_LEVELS:
            self._refuse(f'it is nested more than {MOST_LEVELS} levels deep', event)
        self._level += 1
        node = super().compose_node(parent, index)
        self._level -= 1
        if isinstance(event, yaml.AliasEvent):
            if id(node) not in self._sizes:
                self._refuse(f'alias *{event.anchor} is part of itself', event)
            self._count = before + self._sizes[id(node)]
        else:
            self._sizes[id(node)] = self._count - before
        if self._count > MOST_VALUES:
            self._refuse(f'it has more than {MOST_VALUES} values with what aliases repeat', event)
        return node

    @staticmethod
    def _refuse(text: str, event: Any) -> None:
        raise yaml.composer.ComposerError(None, None, text, event.start_mark)

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        """Name the value where PyYAML has errors of its own, or an integer of any size."""
        try:
            value = super().construct_object(node, deep)
            if isinstance(value, int):
                value.to_bytes(8, 'little', signed=True)
        except (ValueError, KeyError, OverflowError) as error:
            kind = node.tag.rpartition(':')[2]
            limit = ' of 64 bits' if kind == 'int' else ''
            raise yaml.constructor.ConstructorError(
                None, None, f'{str(node.value)[:40]!r} is no {kind}{limit}', node.start_mark
            ) from error
        return value
