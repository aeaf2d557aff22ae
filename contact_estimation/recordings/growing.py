# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A recording that is still being written, read as it grows."""

from __future__ import annotations

from pathlib import Path
from typing import Iterable

from mcap.opcode import Opcode

from .chunk_reader import Channels, read_chunk, RecordedMessage
from .record_scanner import MAGIC, RecordScanner
from .topic_names import canonical

_ENDS = (Opcode.DATA_END, Opcode.FOOTER)


class GrowingRecording:
    """
    Read the messages that a recorder has flushed since the last call.

    It needs no subscription, so it does not affect the recorded nodes.

    finished: whether the recorder has ended the file
    """

    def __init__(self, path: Path, topics: Iterable[str]) -> None:
        self._path, self._position = path, len(MAGIC)
        self._channels = Channels({canonical(topic): topic for topic in topics})
        self.finished = False

    def new_messages(self) -> list[RecordedMessage]:
        """Return what has been added."""
        file = self._file()
        if file is None:
            return []
        messages: list[RecordedMessage] = []
        with open(file, 'rb') as stream:
            size = stream.seek(0, 2)
            if size < self._position:
                return []
            scanner = RecordScanner(stream, size)
            scanner.move(self._position, self._position)
            for record in scanner:
                if record.opcode == Opcode.CHUNK:
                    messages += read_chunk(scanner.content(record), self._channels) or []
                self._position = record.end
            end = scanner.read(self._position, self._position + 1)
            self.finished = bool(end) and end[0] in _ENDS
        return messages

    def _file(self) -> Path | None:
        """Return the file that is written; None before its begin."""
        if not self._path.is_dir():
            return self._path if self._path.is_file() else None
        return next(iter(sorted(self._path.glob('*.mcap'))), None)
