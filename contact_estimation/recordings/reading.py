# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Reading recordings of any length, also those whose recorder was killed."""

from pathlib import Path
from typing import Collection, Iterator

from .adaptation import changed, changes_of
from .bag_folder import needs_rosbags, recording_files
from .chunk_reader import decompressed, RecordedMessage
from .mcap_file import McapFile
from .rosbags_file import RosbagsFile
from .source import canonical, RecordingSource, require_topics
from .table_file import reads_as_table, TableFile
from ..exceptions import RecordingError
from ..texts import require_content

__all__ = ['RecordedMessage', 'RecordingReader']


class RecordingReader:
    """
    Read an MCAP file, or a rosbag2 folder of any storage, chunk by chunk.

    Memory is bounded by one chunk. Files that were cut short are read up to the cut; damaged
    chunks are skipped and counted.

    path: as given
    truncated: A file lacks its end: the recorder was killed or still records
    """

    def __init__(self, path: Path | str, source: RecordingSource | None = None) -> None:
        self.path = Path(path)
        self._source = source or RecordingSource()
        self._files = [self._opened(file) for file in recording_files(self.path)]
        self.truncated = not all(file.summary.whole for file in self._files)

    @property
    def damaged_chunks(self) -> int:
        """Return the number of damaged chunks and stretches skipped while reading messages."""
        return sum(file.damaged for file in self._files)

    @property
    def columns(self) -> dict[str, str]:
        """Return the column of each signal of a table; empty for other recordings."""
        return {key: column for file in self._files if isinstance(file, TableFile)
                for key, column in file.columns.items()}

    @property
    def progress(self) -> float:
        """Fraction of the bytes read in the current pass over the messages."""
        total = sum(file.size for file in self._files)
        return sum(file.position for file in self._files) / total

    @property
    def start_ns(self) -> int | None:
        """Log time of the first message [ns], None if unknown without reading all."""
        spans = self._time_spans()
        return min(start for start, _ in spans) if spans else None

    @property
    def end_ns(self) -> int | None:
        """Log time of the last message [ns], None if unknown without reading all."""
        spans = self._time_spans()
        return max(end for _, end in spans) if spans else None

    def topics(self, asked: Collection[str] | None = None) -> dict[str, str]:
        """Find the topics and their types."""
        types: dict[str, str] = {}
        missing = None if asked is None else {canonical(topic) for topic in asked}
        for file in self._files:
            types.update(file.topics(missing))
            if missing is not None:
                missing -= {canonical(topic) for topic in types}
        return types

    def metadata(self) -> dict[str, dict[str, str]]:
        """Read the metadata records, such as the parameters at start."""
        found: dict[str, dict[str, str]] = {}
        for file in self._files:
            for name, values in file.metadata().items():
                found.setdefault(name, {}).update(values)
        return found

    def messages(self, topics: Collection[str] | None = None) -> Iterator[RecordedMessage]:
        """Read messages one by one."""
        return (message for batch in self.batches(topics) for message in batch)

    def batches(self, topics: Collection[str] | None = None) -> Iterator[list[RecordedMessage]]:
        """Read messages chunk by chunk, which is faster than one by one."""
        wanted, changes = None, {}
        if topics is not None:
            types = self.topics(topics)
            hidden = sum(file.hidden for file in self._files)
            if hidden and {canonical(topic) for topic in topics} - set(map(canonical, types)):
                raise RecordingError(
                    f'recording {self.path} has {hidden} damaged stretch(es), and what describes '
                    f'{", ".join(topics)} is in none that can be read (there: '
                    f'{", ".join(types) or "no topic"}); use another copy of the file, or '
                    'recover it with: mcap recover')
            if self.truncated and not types:
                raise RecordingError(
                    f'recording {self.path} must hold messages, but it ends before the first '
                    'topic; end the recorder before copying its file, or record again')
            require_topics(topics, types, f'recording {self.path}')
            wanted = {canonical(topic): topic for topic in topics}
            changes = changes_of(
                self._source, {name: kind for name, kind in types.items()
                               if canonical(name) in wanted},
                self._definition_of, f'recording {self.path}')
        batches = self._batches(wanted)
        return changed(batches, changes) if changes else batches

    def _definition_of(self, type_name: str) -> str:
        return next((file.definitions[type_name] for file in self._files
                     if type_name in file.definitions), '')

    def _opened(self, file: Path) -> McapFile | RosbagsFile | TableFile:
        try:
            if not file.is_dir():
                require_content(file)
        except (OSError, ValueError) as error:
            raise RecordingError(
                f'cannot read recording {file}: {getattr(error, "strerror", error)}; give an '
                'existing .mcap file, rosbag2 folder or table') from error
        if reads_as_table(file):
            return TableFile(file, self._source)
        return RosbagsFile(file) if needs_rosbags(file) else McapFile(file)

    def _batches(self, wanted: dict[str, str] | None) -> Iterator[list[RecordedMessage]]:
        """Read one file after the other."""
        for file in self._files:
            file.position = file.damaged = 0
        for file in self._files:
            yield from map(decompressed, file.batches(wanted))

    def _time_spans(self) -> list[tuple[int, int]]:
        """Collect the time spans of the files that have one."""
        spans = (file.time_span() for file in self._files)
        return [span for span in spans if span is not None]
