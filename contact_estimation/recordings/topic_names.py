# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Topic names with and without leading slash, and checks that topics are recorded."""

from __future__ import annotations

import difflib
from typing import Collection, Mapping

from ..exceptions import RecordingError

_ROLES = ('wrench', 'joint_states', 'reference_trajectory')


def canonical(topic: str) -> str:
    """Write a topic name with its leading slash: 'wrench' and '/wrench' are the same."""
    return '/' + topic.strip('/')


def require_topics(asked: Collection[str], types: Mapping[str, str], where: str) -> None:
    """Check that a recording has the requested topics."""
    present = {canonical(topic) for topic in types}
    missing = [topic for topic in asked if canonical(topic) not in present]
    if not missing:
        return
    there = ', '.join(f'{topic} ({types[topic]})' for topic in sorted(types)) or 'no topics'
    role = missing[0].rsplit('/', 1)[-1]
    likewise = ''
    if role not in _ROLES:  # chosen with --topic for an unknown role
        role, likewise = _ROLES[0], f' (likewise {", ".join(_ROLES[1:])})'
    raise RecordingError(
        f'{where} has no topic {", ".join(canonical(topic) for topic in missing)}; it has: '
        f'{there}; say which one to read with --topic {role}:='
        f'{_nearest(missing[0], types)}{likewise}')


def _nearest(topic: str, types: Mapping[str, str]) -> str:
    """Suggest the topic with the most similar last part."""
    by_last_part = {name.rsplit('/', 1)[-1]: name for name in sorted(types)}
    wanted = topic.rsplit('/', 1)[-1]
    near = difflib.get_close_matches(wanted, by_last_part, n=1, cutoff=0.5)
    return by_last_part[near[0]] if near else '/name'
