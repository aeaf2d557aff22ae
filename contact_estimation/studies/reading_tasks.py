# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""References of the replay benchmark, each run as a command: only read a recording."""

from __future__ import annotations

from pathlib import Path
import sys
from typing import Callable

TOPICS = ('wrench', 'joint_states')


def deserialise_with_rosbags(path: Path) -> int:
    """Deserialise every message of the two topics into an object."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import get_typestore, Stores

    count = 0
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
        wanted = [c for c in reader.connections if c.topic.strip('/') in TOPICS]
        for connection, _, data in reader.messages(wanted):
            reader.deserialize(data, connection.msgtype)
            count += 1
    return count


def read_messages(path: Path) -> int:
    """Read the raw messages of the two topics with this package."""
    from ..recordings import RecordingReader

    return sum(map(len, RecordingReader(path).batches(TOPICS)))


TASKS: dict[str, Callable[[Path], int]] = {
    'rosbags': deserialise_with_rosbags,
    'reader': read_messages,
}

if __name__ == '__main__':
    print(f'{TASKS[sys.argv[1]](Path(sys.argv[2]))} messages')
