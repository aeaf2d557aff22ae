# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Tables as recordings: rows become messages, messages become rows."""

from __future__ import annotations

from functools import partial
from math import isnan, nan
from pathlib import Path
from typing import Any, Callable, Collection, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .chunk_reader import RecordedMessage
from .columns import columns_of_signals, is_effort, signals_of_columns
from .encoding import encode_arm, WrenchEncoder
from .mcap_records import Summary
from .source import RecordingSource
from .table import read_columns
from .topic_names import canonical

_BATCH = 5000  # rows
FORCES = tuple(f'wrench.{kind}.{axis}' for kind in ('force', 'torque') for axis in 'xyz')
RATES = {'joint': ('velocity', 'effort'), 'reference': ('velocity', 'acceleration', 'effort')}
TYPES = {'wrench': 'geometry_msgs/msg/WrenchStamped', 'joint_states': 'sensor_msgs/msg/JointState',
         'reference_trajectory': 'trajectory_msgs/msg/JointTrajectory'}
Rows = NDArray[np.float64]


class TableFile:
    """Read a table with the interface of `McapFile`; columns: column of each signal."""

    hidden = damaged = 0
    definitions: Mapping[str, str] = {}

    def __init__(self, path: Path, source: RecordingSource) -> None:
        self.path, self.summary, self.position = path, Summary(whole=True), 0
        columns, where = read_columns(path), f'table {path}'
        stamp_ns, signals = signals_of_columns(columns, source.columns, source.units, where)
        self.columns = columns_of_signals(columns, source.columns, where)
        for key, column in self.columns.items():
            if odd := columns.odd.get(column.removeprefix('-')):
                self.columns[key] += f' ({odd[0]} cells hold no number, the first {odd[1][:40]!r})'
        order = np.argsort(stamp_ns, kind='stable')
        self._stamp_ns = stamp_ns[order]
        self._topics = {getattr(source, name): (TYPES[name], encode, rows[order]) for name, (
            encode, rows) in messages_of(signals, len(order)).items()}
        self.size = max(1, len(order))

    def batches(self, wanted: Mapping[str, str] | None) -> Iterator[list[RecordedMessage]]:
        names = {topic: topic if wanted is None else wanted[canonical(topic)]
                 for topic in self._topics if wanted is None or canonical(topic) in wanted}
        for begin in range(0, len(self._stamp_ns), _BATCH):
            part = slice(begin, begin + _BATCH)
            self.position = min(begin + _BATCH, self.size)
            columns = [(name, *self._topics[topic][1:]) for topic, name in names.items()]
            yield [RecordedMessage(name, stamp_ns, encode(stamp_ns, row))
                   for place, stamp_ns in enumerate(self._stamp_ns[part].tolist(), begin)
                   for name, encode, rows in columns
                   # A row may lack what is sampled at another rate.
                   if not isnan((row := rows[place].tolist())[0])]

    def topics(self, asked: Collection[str] | None) -> dict[str, str]:
        """Return the type of each topic."""
        return {topic: type_name for topic, (type_name, *_) in self._topics.items()}

    def metadata(self) -> dict[str, dict[str, str]]:
        """Return no records: a table has none."""
        return {}

    def time_span(self) -> tuple[int, int] | None:
        """Return the times of the first and the last row [ns]."""
        return int(self._stamp_ns[0]), int(self._stamp_ns[-1])


def messages_of(
    signals: Mapping[str, Rows], count: int
) -> dict[str, tuple[Callable[[int, Sequence[float]], bytes], Rows]]:
    """
    Arrange signals as the messages of topics.

    signals (N,): by key, as of `signals_of_columns`
    count: n
    Returns messages (N, n): by name of the topic: what encodes stamp and row, and the rows; one
    that begins with NaN is no message
    """
    force = np.array([signals.get(key, np.zeros(count)) for key in FORCES]).T
    present = [key for key in FORCES if key in signals]
    found: dict[str, Any] = {}
    if present:
        force[np.isnan([signals[key] for key in present]).any(axis=0)] = nan
        wrenches = WrenchEncoder('')
        found['wrench'] = lambda stamp_ns, row: wrenches.encode(stamp_ns, *row), force
    for topic, kind in (('joint_states', 'joint'), ('reference_trajectory', 'reference')):
        names = [key[len(kind) + 1:] for key in signals if key.startswith(f'{kind}.')
                 and not key.endswith(tuple('.' + rate for rate in RATES[kind]))]
        if names:
            efforts = any(map(is_effort, signals))
            rates = RATES[kind] if kind == 'reference' or efforts else ('velocity',)
            keys = [f'{kind}.{name}{rate}' for rate in ('', *('.' + r for r in rates))
                    for name in names]
            rows = np.array([signals.get(key, np.full(count, nan)) for key in keys]).T
            found[topic] = partial(_encode, names, topic), rows
    return found


def _encode(names: Sequence[str], topic: str, stamp_ns: int, row: Sequence[float]) -> bytes:
    """Encode a row of positions, followed by their rates."""
    count, is_point = len(names), topic == 'reference_trajectory'
    rows = [row[at:at + count] for at in range(0, len(row), count)]
    if not is_point and len(rows) < 3:
        rows.append(())  # no efforts
    return encode_arm(stamp_ns, names, *rows, point=is_point)
