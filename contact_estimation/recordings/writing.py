# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Writing recordings, a rosbag2 folder or a single MCAP file, in chunks that survive a kill."""

from contextlib import contextmanager
from operator import itemgetter
from pathlib import Path
import threading
from types import TracebackType
from typing import Iterable, Iterator

from mcap.writer import CompressionType, Writer
import yaml

from .bag_folder import bag_information, OfferedQos, RecordedTopic, write_bag_metadata
from .encoding import message_definition
from .source import canonical, TYPES
from ..exceptions import RecordingError

CHUNK_BYTES = 64 * 1024
CHUNK_SPAN_NS = 500_000_000

_MESSAGE_RECORD_BYTES = 31  # opcode, length, channel, sequence and two times
_OTHER_RECORD_BYTES = 128  # at least what a schema or channel record adds to its texts
_DEFAULT_QOS = OfferedQos()


class RecordingWriter:
    """
    Write messages as they arrive; created by `folder` or `file`.

    Chunks are small in bytes and short in time: SIGKILL destroys only the one in progress, at most
    0.5 s of log time. Methods may be called from several threads: a timer flushes while another
    thread writes.

    path: the .mcap file
    """

    def __init__(self, path: Path, bag_folder: Path | None) -> None:
        self.path = path
        self._bag_folder = bag_folder
        self._lock = threading.Lock()
        self._topics: dict[str, RecordedTopic] = {}
        self._schemas: dict[str, int] = {}
        self._span_ns: tuple[int, int] | None = None
        self._chunk_bytes = 0
        self._chunk_start_ns: int | None = None
        self._closed = False
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            # 'x': between two processes with the same output, the second fails.
            self._stream = open(path, 'xb')
            self._writer = Writer(
                self._stream, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD)
            self._writer.start(profile='ros2', library='contact_estimation')
            self._stream.flush()
        except FileExistsError:
            raise _exists(path) from None
        except OSError as error:
            raise RecordingError(
                f'cannot write recording {path}: {error.strerror}; choose another output'
            ) from error

    @classmethod
    def folder(cls, path: Path | str) -> 'RecordingWriter':
        """Start a rosbag2 folder."""
        folder = Path(path)
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise _exists(folder)
        return cls(folder / f'{folder.resolve().name}_0.mcap', folder)

    @classmethod
    def file(cls, path: Path | str) -> 'RecordingWriter':
        """Start a single MCAP file."""
        return cls(Path(path), None)

    def write(
        self,
        topic: str,
        type_name: str,
        data: bytes,
        log_time_ns: int,
        publish_time_ns: int | None = None,
        qos: OfferedQos = _DEFAULT_QOS,
    ) -> None:
        """
        Write one message; the first of a topic registers the topic.

        topic: name of the topic
        type_name: such as 'geometry_msgs/msg/WrenchStamped'
        data: CDR with its encapsulation header
        log_time_ns: time of reception [ns]
        publish_time_ns: time of publication [ns]; the log time by default
        qos: quality of service of the publisher; only that of the first message of a topic is used
        """
        with self._writing():
            self._require_open()
            entry = self._topics.get(topic) or self._add_topic(topic, type_name, qos)
            if entry.type_name != type_name:
                raise RecordingError(
                    f'topic {topic!r} is recorded as {entry.type_name}, got a {type_name}; '
                    'record it under another name')
            published = log_time_ns if publish_time_ns is None else publish_time_ns
            self._writer.add_message(entry.channel, log_time_ns, data, published)
            entry.message_count += 1
            self._chunk_bytes += len(data) + _MESSAGE_RECORD_BYTES
            if self._chunk_start_ns is None:
                self._chunk_start_ns = log_time_ns
            # Absolute value: the clock of a simulation jumps back when the simulation restarts.
            span = abs(log_time_ns - self._chunk_start_ns)
            if self._chunk_bytes > CHUNK_BYTES or span >= CHUNK_SPAN_NS:
                self._finish_chunk()
            begin, end = self._span_ns or (log_time_ns, log_time_ns)
            self._span_ns = min(begin, log_time_ns), max(end, log_time_ns)

    def write_metadata(self, name: str, values: dict[str, str]) -> None:
        """Write named texts, such as the parameters at start."""
        with self._writing():
            self._require_open()
            self._writer.add_metadata(name, values)
            self._stream.flush()

    def flush(self) -> None:
        """Hand everything written so far to the operating system, where a kill cannot reach."""
        with self._writing():
            if not self._closed:
                self._finish_chunk()

    def close(self) -> None:
        """Finish the recording; further calls do nothing."""
        with self._writing():
            if not self._closed:
                self._closed = True
                self._finish()

    def __enter__(self) -> 'RecordingWriter':
        """Return the writer."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Finish the recording, also after an error, to keep what was recorded."""
        self.close()

    def _finish_chunk(self) -> None:
        """Hand the chunk in progress to the operating system."""
        if self._chunk_start_ns is not None:
            # Old versions of the package mcap have a private method instead of `flush`.
            (getattr(self._writer, 'flush', None) or getattr(
                self._writer, '_Writer__finalize_chunk'))()
            self._stream.flush()
            self._chunk_bytes, self._chunk_start_ns = 0, None

    def _finish(self) -> None:
        """Write the metadata that rosbag2 adds at the end and close the file."""
        information = bag_information(
            self.path.name, self._topics.values(), *(self._span_ns or (0, 0)))
        if self._bag_folder is not None:
            self._finish_chunk()
            # rosbag2 keeps a copy of metadata.yaml in the file, for `ros2 bag info FILE`.
            self._writer.add_metadata(
                'rosbag2', {'serialized_metadata': yaml.safe_dump(information, sort_keys=False)})
        self._writer.finish()
        self._stream.close()
        if self._bag_folder is not None:
            write_bag_metadata(self._bag_folder, information)

    def _add_topic(self, topic: str, type_name: str, qos: OfferedQos) -> RecordedTopic:
        """Register a topic as rosbag2 does."""
        definition = message_definition(type_name)
        if type_name not in self._schemas:
            self._schemas[type_name] = self._writer.register_schema(
                type_name, 'ros2msg', definition.text.encode())
        metadata = {'offered_qos_profiles': qos.as_text(),
                    'topic_type_hash': definition.type_hash}
        channel = self._writer.register_channel(topic, 'cdr', self._schemas[type_name], metadata)
        self._chunk_bytes += (len(definition.text) + sum(map(len, metadata.values()))
                              + _OTHER_RECORD_BYTES)
        entry = self._topics[topic] = RecordedTopic(
            topic, type_name, definition.type_hash, qos, channel)
        return entry

    def _require_open(self) -> None:
        """Raise an error if the recording is closed."""
        if self._closed:
            raise RecordingError(f'recording {self.path} is closed; open a new one')

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Exclude other threads; report errors of the file system."""
        with self._lock:
            try:
                yield
            except OSError as error:
                raise RecordingError(
                    f'cannot write to recording {self.path}: {error.strerror}; what was written '
                    'before can be read') from error


def _exists(path: Path) -> RecordingError:
    """Explain that nothing is overwritten."""
    return RecordingError(
        f'{path} exists and recordings are never overwritten; choose another output or remove it')


def write_messages(
    path: Path, messages: Iterable[tuple[int, str, bytes]], transport_ns: int = 0
) -> None:
    """Write stamps [ns], topics by their role and messages, which are received a time later."""
    with RecordingWriter.file(path) as writer:
        for stamp_ns, role, data in sorted(messages, key=itemgetter(0)):
            writer.write(canonical(role), TYPES[role], data, stamp_ns + transport_ns)
