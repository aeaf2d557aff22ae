# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Foreign messages and stamps as those that the package expects."""

from math import nan
import re
from struct import pack
from typing import Any, Callable, Iterator, Mapping

import numpy as np

from .cdr import NS_PER_S
from .chunk_reader import RecordedMessage
from .encoding import fresh_typestore, WrenchEncoder
from .source import canonical, RecordingSource, TYPES
from ..exceptions import MessageError, RecordingError

Change = Callable[[bytes, int], bytes]  # of raw message and time of reception [ns]

RECEIVED = 'received'
STAMPS = ('header', RECEIVED)
_PLAIN = 'geometry_msgs/msg/Wrench'
_MOST_FIELDS = 30  # listed in an error


def changes_of(
    source: RecordingSource, types: Mapping[str, str], definition_of: Callable[[str], str],
    where: str,
) -> dict[str, Change]:
    """Return what turns the messages of a recording into those that are expected."""
    received = source.stamps == RECEIVED
    changes: dict[str, Change] = {}
    for role, expected in TYPES.items():
        topic = canonical(getattr(source, role))
        recorded = next((t for name, t in types.items() if canonical(name) == topic), '')
        if role == 'wrench' and recorded and (source.wrench_field or recorded != expected):
            field = source.wrench_field or ('' if recorded == _PLAIN else None)
            changes[topic] = _wrench(recorded, field, definition_of(recorded), received,
                                     f'topic {topic} of {where}')
        elif recorded and recorded != expected:
            raise RecordingError(
                f'topic {topic} of {where} has the type {recorded}, expected {expected}; say '
                f'which one to read with --topic {role}:=/name')
        elif received:
            changes[topic] = _restamped
    return changes


def changed(
    batches: Iterator[list[RecordedMessage]], changes: Mapping[str, Change]
) -> Iterator[list[RecordedMessage]]:
    """Yield batches with their messages changed; one that cannot be changed stays as it is."""
    for batch in batches:
        yield [message._replace(data=_attempt(changes[canonical(message.topic)], message))
               if canonical(message.topic) in changes else message for message in batch]


def _attempt(change: Change, message: RecordedMessage) -> bytes:
    try:
        return change(message.data, message.log_time_ns)
    except (ValueError, MessageError):
        return message.data  # counted as malformed where it is decoded


def _restamped(data: bytes, time_ns: int) -> bytes:
    """Replace the header's stamp, the first field."""
    order = '<' if data[1:2] == b'\1' else '>'
    return data[:4] + pack(order + 'iI', *divmod(time_ns, NS_PER_S)) + data[12:]


def _wrench(kind: str, field: str | None, definition: str, received: bool, where: str) -> Change:
    """Return what makes a WrenchStamped of other messages."""
    try:
        store = fresh_typestore(kind, definition)
    except RecordingError as error:
        raise RecordingError(f'{where} has the type {kind}, expected {TYPES["wrench"]}; {error}')
    if field is None:
        raise RecordingError(
            f'{where} has the type {kind}, expected {TYPES["wrench"]}; choose force and torque '
            f'with --wrench-field FIELD, such as {_example(store, kind)}; it holds: '
            f'{_listed(store, kind)}')
    stamped = bool(store.fielddefs[kind][1]) and store.fielddefs[kind][1][0][0] == 'header'
    if not stamped and not received:
        raise RecordingError(
            f'{where} has the type {kind}, which has no stamp; take the time of reception, for '
            'all topics, with --stamps received')
    encoder, path = WrenchEncoder(''), _path(field, where)

    def change(data: bytes, time_ns: int) -> bytes:
        message = store.deserialize_cdr(data, kind)
        if stamped and not received:
            time_ns = message.header.stamp.sec * NS_PER_S + message.header.stamp.nanosec
        try:
            value = message
            for part in path:
                value = getattr(value, part) if isinstance(part, str) else value[part]
            wrench = _numbers(value)
        except (AttributeError, IndexError, TypeError, ValueError) as error:
            raise RecordingError(
                f'--wrench-field {field!r} must lead to 1, 3 or 6 numbers, but in a message on '
                f'{where} it does not; it holds: {_listed(store, kind)}') from error
        return encoder.encode(time_ns, *wrench)

    return change


def _path(field: str, where: str) -> list[str | int | slice]:
    """Split a path such as state.wrenches[2].force or data[0:6]."""
    parts = re.findall(r'(\w+)|\[(\d+)(?::(\d+))?\]', field)
    if re.sub(r'\.?\w+|\[\d+(:\d+)?\]', '', field):
        raise RecordingError(
            f'--wrench-field must be a path such as wrench.force or data[0:6], got {field!r} for '
            f'{where}')
    return [name if name else slice(int(first), int(last)) if last else int(first)
            for name, first, last in parts]


def _numbers(value: Any) -> list[float]:
    """Return force and torque of a wrench, a vector, numbers in a row, or one number: force.x."""
    if hasattr(value, 'wrench'):
        value = value.wrench
    if hasattr(value, 'force'):
        return [*_numbers(value.force)[:3], *_numbers(value.torque)[:3]]
    if hasattr(value, 'x'):
        value = [value.x, value.y, value.z]
    row = np.asarray(value, np.float64).ravel()
    if len(row) not in (1, 3, 6):
        raise ValueError
    return [float(number) for number in row] + [0.0 if np.isfinite(row).all() else nan] * (
        6 - len(row))


def _listed(store: Any, kind: str) -> str:
    """List the fields with numbers of a message."""
    fields = list(_fields(store, kind, ''))
    return ', '.join(fields[:_MOST_FIELDS]) + (', ...' if len(fields) > _MOST_FIELDS else '')


def _example(store: Any, kind: str) -> str:
    """Return the path of numbers that may be a force: a vector, else several, else one."""
    paths = [field.split()[0] for field in _fields(store, kind, '') if '(float' in field]
    path = min(paths, key=lambda one: (not one.endswith('.x'), '[' not in one), default='data[]')
    return re.sub(r'\[[^]]*\](?=\.)', '[0]', path).removesuffix('.x').replace('[]', '[0:6]')


def _fields(store: Any, kind: str, prefix: str) -> Iterator[str]:
    for name, (node, argument) in store.fielddefs[kind][1]:
        several = int(node) > 2  # an array or a sequence
        ((inner, argument), count) = argument if several else ((node, argument), None)
        end = f'{prefix}{name}' + (f'[0:{count}]' if count else '[]' if several else '')
        if int(inner) == 2:
            yield from _fields(store, argument, end + '.')
        elif argument[0].startswith(('float', 'int', 'uint')):
            yield f'{end} ({argument[0]})'
