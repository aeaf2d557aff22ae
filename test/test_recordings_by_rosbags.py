# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Bags stored as SQLite or compressed by rosbag2 hold what the same bag holds as MCAP."""

from __future__ import annotations

from pathlib import Path
import sys
from typing import Any

from contact_estimation.commands.replay import main as replay
from contact_estimation.exceptions import MissingPackageError, RecordingError
from contact_estimation.pipeline.events import EstimationEvent, START
from contact_estimation.recordings import chunk_reader, RecordingReader, rosbags_file
from contact_estimation.recordings.encoding import encode_string, JointStateEncoder, WrenchEncoder
from core_runs import contact_samples
import pytest

rosbag2 = pytest.importorskip('rosbags.rosbag2')
typesys = pytest.importorskip('rosbags.typesys')

FORMATS = [('SQLITE3', None), ('SQLITE3', 'FILE'), ('SQLITE3', 'MESSAGE'), ('MCAP', 'FILE'),
           ('MCAP', 'MESSAGE')]
SAMPLES = contact_samples(1.0, 5000.0, 100.0, force_noise=0.6)
TYPES = {'/wrench': 'geometry_msgs/msg/WrenchStamped',
         '/joint_states': 'sensor_msgs/msg/JointState',
         '/estimator_node/events': 'std_msgs/msg/String'}


def messages(**parameters: Any) -> list[tuple[str, int, bytes]]:
    """Make what a recorder would receive."""
    start = EstimationEvent(START, -(2**63), parameters)
    found = [('/estimator_node/events', 0, encode_string(start.to_text()))]
    wrenches, joints = WrenchEncoder('tool'), JointStateEncoder('tool', 'x', True)
    for stamp, x, v, F in SAMPLES:
        found.append(('/joint_states', stamp, joints.encode(stamp, x, v)))
        found.append(('/wrench', stamp, wrenches.encode(stamp, F, 0.0, 0.0)))
    return found


def write(folder: Path, storage: str, mode: str | None, **parameters: Any) -> Path:
    """Write a bag with rosbags."""
    store = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)
    writer = rosbag2.Writer(
        folder, version=9, storage_plugin=getattr(rosbag2.StoragePlugin, storage))
    if mode:
        writer.set_compression(
            getattr(writer.CompressionMode, mode)
            if hasattr(writer, 'CompressionMode') else getattr(rosbag2.CompressionMode, mode),
            rosbag2.CompressionFormat.ZSTD)
    with writer:
        connections = {topic: writer.add_connection(topic, kind, typestore=store)
                       for topic, kind in TYPES.items()}
        for topic, stamp, raw in messages(**parameters):
            writer.write(connections[topic], stamp, raw)
    return folder


@pytest.mark.parametrize('storage, mode', FORMATS)
def test_every_message_and_topic_is_read(tmp_path: Path, storage: str, mode: str | None) -> None:
    reader = RecordingReader(write(tmp_path / 'bag', storage, mode))
    assert reader.topics() == TYPES
    assert sorted(map(tuple, reader.messages(['wrench']))) == sorted(
        ('wrench', stamp, raw) for topic, stamp, raw in messages() if topic == '/wrench')
    assert len(list(reader.messages())) == len(messages())
    assert (reader.start_ns, reader.end_ns) == (0, SAMPLES[-1].stamp_ns)
    assert reader.progress == 1.0


def test_database_without_its_folder_is_read(tmp_path: Path) -> None:
    (file,) = write(tmp_path / 'bag', 'SQLITE3', None).glob('*.db3')
    assert len(list(RecordingReader(file).messages())) == len(messages())


def test_replay_of_a_database_takes_the_parameters_of_the_start(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert replay([str(write(tmp_path / 'bag', 'SQLITE3', 'FILE', estimator='kalman'))]) == 0
    assert capsys.readouterr().out.startswith('kalman: 750 samples')


def test_without_rosbags_the_error_says_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = write(tmp_path / 'bag', 'SQLITE3', None)
    monkeypatch.setitem(sys.modules, 'rosbags.rosbag2', None)
    with pytest.raises(MissingPackageError, match='pip install rosbags'):
        RecordingReader(bag)


def test_a_bag_that_decompresses_to_more_than_its_limit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = write(tmp_path / 'bag', 'SQLITE3', 'FILE')
    monkeypatch.setattr(rosbags_file, 'LARGEST_FILE', 1000)
    with pytest.raises(RecordingError, match='more than the limit .* ros2 bag convert'):
        RecordingReader(bag).topics()


@pytest.mark.parametrize('storage', ['SQLITE3', 'MCAP'])
def test_messages_that_decompress_to_more_than_the_limit_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, storage: str
) -> None:
    bag = write(tmp_path / 'bag', storage, 'MESSAGE')
    monkeypatch.setattr(chunk_reader, 'LARGEST_CHUNK', 5000)
    with pytest.raises(RecordingError, match='expected at most'):
        list(RecordingReader(bag).messages())


def test_compressed_messages_are_read_without_the_metadata_of_the_bag(tmp_path: Path) -> None:
    (file,) = write(tmp_path / 'bag', 'MCAP', 'MESSAGE').glob('*.mcap')
    assert sorted(map(tuple, RecordingReader(file).messages())) == sorted(messages())
