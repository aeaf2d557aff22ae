# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The metadata.yaml of a rosbag2 folder, version 9 (ROS 2 Jazzy)."""

from __future__ import annotations

from dataclasses import dataclass
import os
from pathlib import Path
from typing import Any, Collection

import yaml

from .qos import OfferedQos

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
    temporary = folder / (FILE_NAME + '.tmp')
    temporary.write_text(
        yaml.safe_dump({'rosbag2_bagfile_information': information}, sort_keys=False),
        encoding='utf-8',
    )
    os.replace(temporary, folder / FILE_NAME)


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
