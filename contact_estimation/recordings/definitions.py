# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Message definitions and type hashes for the schemas of a recording."""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

from ..exceptions import MissingPackageError, RecordingError


class MessageDefinition(NamedTuple):
    """What a recording says about a message type."""

    text: str  # the .msg text followed by those of all types it contains ('ros2msg' encoding)
    type_hash: str  # RIHS01 hash of the type description


@functools.lru_cache(maxsize=None)
def jazzy_typestore() -> Any:
    """
    Load the message types of ROS 2 Jazzy.

    Imported here and not at the top: only writing needs rosbags, and loading takes 0.1 s.

    """
    try:
        from rosbags.typesys import get_typestore, Stores
    except ImportError as error:
        raise MissingPackageError.of('rosbags', 'a recording with message definitions') from error
    return get_typestore(Stores.ROS2_JAZZY)


def fresh_typestore(type_name: str, definition: str) -> Any:
    """Load the message types of ROS 2 Jazzy and one that a recording defines."""
    jazzy_typestore()
    from rosbags.typesys import get_types_from_msg, get_typestore, Stores

    store = get_typestore(Stores.ROS2_JAZZY)
    try:
        if type_name not in store.fielddefs:
            types = get_types_from_msg(definition, type_name)
            store.register({name: fields for name, fields in types.items()
                            if name not in store.fielddefs})
    except Exception as error:  # rosbags has an error of its own for each way to be wrong
        raise RecordingError(
            f'the recording does not define the message type {type_name} readably: {error}; '
            'record it with rosbag2, which writes definitions') from error
    return store


@functools.lru_cache(maxsize=None)
def message_definition(type_name: str) -> MessageDefinition:
    """Look up a message type of ROS 2 Jazzy."""
    store = jazzy_typestore()
    if type_name not in store.fielddefs:
        raise RecordingError(
            f'cannot record message type {type_name!r}: expected a type of the ROS 2 Jazzy '
            "distribution, written like 'geometry_msgs/msg/WrenchStamped'")
    text, _ = store.generate_msgdef(type_name, ros_version=2)
    return MessageDefinition(text, store.hash_rihs01(type_name))
