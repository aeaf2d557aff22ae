# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A rosbag2 folder: its files, and its metadata.yaml, version 9 (ROS 2 Jazzy)."""

import dataclasses
from dataclasses import dataclass
import hashlib
import os
from pathlib import Path, PurePosixPath
import re
from typing import Any, Collection, Iterable

import yaml

from ..exceptions import RecordingError
from ..texts import write_whole, yaml_file


# What rmw calls an infinite duration.
_INFINITE = {'sec': 9223372036, 'nsec': 854775807}


@dataclasses.dataclass(frozen=True)
class OfferedQos:
    """Quality of service of a publisher."""

    reliability: str = 'reliable'  # 'reliable' or 'best_effort'
    depth: int = 10  # length of the queue
    durability: str = 'volatile'  # 'volatile' or 'transient_local'
    history: str = 'keep_last'  # 'keep_last' or 'keep_all'

    @classmethod
    def of_profile(cls, profile: Any) -> 'OfferedQos':
        """Convert a rclpy.qos.QoSProfile."""
        return cls(
            reliability=profile.reliability.name.lower(),
            depth=profile.depth,
            durability=profile.durability.name.lower(),
            history=profile.history.name.lower(),
        )

    def as_profiles(self) -> list[dict[str, Any]]:
        """Return the list of profiles that rosbag2 writes to metadata.yaml (version 9)."""
        return [
            {
                'history': self.history,
                'depth': self.depth,
                'reliability': self.reliability,
                'durability': self.durability,
                'deadline': dict(_INFINITE),
                'lifespan': dict(_INFINITE),
                'liveliness': 'automatic',
                'liveliness_lease_duration': dict(_INFINITE),
                'avoid_ros_namespace_conventions': False,
            }]

    def as_text(self) -> str:
        """Return the profiles as the YAML text that rosbag2 writes to an MCAP channel."""
        return yaml.safe_dump(self.as_profiles(), sort_keys=False).strip()


FILE_NAME = 'metadata.yaml'


@dataclass
class RecordedTopic:
    """A topic of a recording."""

    # name, type_name, type_hash: name of the topic, type of its messages and RIHS01 hash of the
    # type
    name: str
    type_name: str
    type_hash: str
    qos: OfferedQos  # of the publisher
    channel: int  # channel in the MCAP file
    message_count: int = 0  # messages so far


def bag_information(
    file_name: str, topics: Collection[RecordedTopic], start_ns: int, end_ns: int
) -> dict[str, Any]:
    """
    Describe a bag of one file as rosbag2 does.

    file_name: name of the .mcap file in the folder
    topics: the topics in the order of their first message
    start_ns, end_ns: log time of the first and the last message [ns]
    """
    count = sum(topic.message_count for topic in topics)
    starting_time = {'nanoseconds_since_epoch': start_ns}
    duration = {'nanoseconds': end_ns - start_ns}
    return {
        'version': 9,
        'storage_identifier': 'mcap',
        'duration': dict(duration),
        'starting_time': dict(starting_time),
        'message_count': count,
        'topics_with_message_count': [_topic_entry(topic) for topic in topics],
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': [file_name],
        'files': [
            {
                'path': file_name,
                'starting_time': dict(starting_time),
                'duration': dict(duration),
                'message_count': count,
            }
        ],
        'custom_data': None,
        'ros_distro': 'jazzy',
    }


def write_bag_metadata(folder: Path, information: dict[str, Any]) -> None:
    """Write metadata.yaml atomically."""
    text = yaml.safe_dump({'rosbag2_bagfile_information': information}, sort_keys=False)
    write_whole(folder / FILE_NAME, text.encode('utf-8'))


def _topic_entry(topic: RecordedTopic) -> dict[str, Any]:
    """Describe one topic."""
    return {
        'topic_metadata': {
            'name': topic.name,
            'type': topic.type_name,
            'serialization_format': 'cdr',
            'offered_qos_profiles': topic.qos.as_profiles(),
            'type_description_hash': topic.type_hash,
        },
        'message_count': topic.message_count,
    }


_SQLITE = b'SQLite format 3\0'


def recording_files(path: Path) -> list[Path]:
    """List the files of a recording in the order in which they were written."""
    if not path.exists():
        raise RecordingError(
            f'recording {path} does not exist; give an .mcap file, a rosbag2 folder or a table')
    if not path.is_dir():
        return [path]
    information = _information(path / FILE_NAME)
    if information is not None:
        return _listed_files(path, information)
    files = sorted(path.glob('*.mcap'), key=lambda file: natural_order(file.name))
    if len({re.sub(r'_\d+$', '', file.stem) for file in files}) > 1:
        raise RecordingError(
            f'folder {path} holds several recordings ({_listed(files)}) and no metadata.yaml; '
            'expected one recording, whose files differ in a number at the end; give one of them')
    if files:
        return files
    files = sorted(path.glob('*.db3'), key=lambda file: natural_order(file.name))
    if files:
        return files
    raise RecordingError(
        f'folder {path} holds no recording: expected metadata.yaml or *.mcap, '
        f'got {_listed(path.iterdir())}; give an .mcap file or a rosbag2 folder')


def needs_rosbags(path: Path) -> bool:
    """Return whether a file of a recording is not MCAP but what the package rosbags reads."""
    if path.is_dir():
        return True
    try:
        with open(path, 'rb') as stream:
            return stream.read(len(_SQLITE)) == _SQLITE
    except OSError:
        return False


def _information(path: Path) -> dict[str, Any] | None:
    """Read metadata.yaml; None where it is missing or was cut short."""
    try:
        content = yaml_file(path)
        information = content['rosbag2_bagfile_information']
        return information if information['relative_file_paths'] else None
    except (OSError, ValueError, TypeError, KeyError):
        return None


def _listed_files(folder: Path, information: dict[str, Any]) -> list[Path]:
    """Return the files that metadata.yaml lists."""
    if str(information.get('compression_mode')).lower() == 'file':
        return [folder]
    # Old versions wrote the folder's name before that of the file.
    files = [folder / PurePosixPath(str(p)).name for p in information['relative_file_paths']]
    missing = [file.name for file in files if not file.exists()]
    if missing:
        raise RecordingError(
            f'recording {folder} lacks {", ".join(missing)}, which its {FILE_NAME} lists; '
            f'copy the whole folder, or remove {FILE_NAME} to read what is there')
    return files


def natural_order(name: str) -> list[tuple[int, str]]:
    """Return a sorting key that puts bag_10.mcap after bag_9.mcap."""
    return [(int(part), '') if part.isdecimal() else (-1, part)
            for part in re.split(r'([0-9]+)', name)]


def _listed(entries: Iterable[Path]) -> str:
    """Name the first of some entries of a folder."""
    names = sorted(entry.name for entry in entries)
    return ', '.join(names[:3]) + (' and more' if len(names) > 3 else '') or 'nothing'


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
