# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings from arrays and to arrays: signals by the names of the columns of a table."""

from math import isnan, nan
from os import PathLike
from pathlib import Path
from typing import Any, Mapping, Sequence, TextIO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .cdr import CdrCursor
from .columns import is_effort, is_key, KEYS
from .decoding import decode_arm, ForceTorqueDecoder, JointsDecoder, TrajectoryDecoder
from .reading import RecordingReader
from .recorded_signals import gather
from .source import canonical, RecordingSource, TYPES
from .table_file import FORCES, messages_of, RATES, require_a_table
from .writing import RecordingWriter
from ..exceptions import MessageError, RecordingError, SignalShapeError, UnknownNameError

Signals = dict[str, NDArray[Any]]


def read_table(
    path: str | PathLike[str], *, topics: Mapping[str, str] | None = None, **reading: Any
) -> Signals:
    """
    Read a table or a recording as arrays.

    Parameters
    ----------
    path : str or path-like
        CSV, Parquet or MAT file, `.mcap` file or rosbag2 folder.
    topics : mapping of str to str, optional
        As of `read_recording`.
    **reading
        columns, units, stamps and wrench_field, see `RecordingSource`.

    Returns
    -------
    signals : dict of str to ndarray, shape (N,)
        't' [s] from the first row, 't_ns' [ns], 'wrench.force.x' [N] to 'wrench.torque.z' [N m],
        'joint.NAME' [m] or [rad], 'joint.NAME.velocity', 'reference.NAME' with .velocity,
        .acceleration and .effort [N]; a row for each stamp, NaN where a topic has no sample.

    Raises
    ------
    RecordingError
        If it cannot be read, lacks time, force or position, or is a bag and columns are chosen.

    """
    source = RecordingSource.of_topics(topics or {}, **reading)
    require_a_table([str(path)], source.columns, source.units)
    signals = signals_of_recording(RecordingReader(str(path), source), source)
    return {'t': 1e-9 * (signals['t_ns'] - signals['t_ns'][0]), **signals}


def write_recording(path: str | PathLike[str], signals: Mapping[str, ArrayLike]) -> None:
    """
    Write arrays as a recording that all commands read.

    Parameters
    ----------
    path : str or path-like
        New `.mcap` or `.csv` file.
    signals : mapping of str to array_like, shape (N,)
        As of `read_table`, in SI units: the time of each row as 't' [s] or 't_ns' [ns], at least
        one force and one joint; other signals may be missing. NaN: no sample in that row.

    Raises
    ------
    UnknownNameError
        If a name is no signal.
    SignalShapeError
        If arrays differ in length.
    RecordingError
        If time, force or position is missing, or the file exists or cannot be written.

    """
    arrays = _checked(signals)
    if Path(path).suffix.lower() == '.csv':
        write_csv(Path(path), arrays)
        return
    stamps_ns = arrays.pop('t_ns').tolist()
    topics = messages_of(arrays, len(stamps_ns))
    with RecordingWriter.file(Path(path)) as writer:
        rows = {topic: messages.rows(slice(None)) for topic, messages in topics.items()}
        for place, stamp_ns in enumerate(stamps_ns):
            for topic, messages in topics.items():
                if not isnan((row := rows[topic][place])[0]):
                    writer.write(canonical(topic), TYPES[topic], messages.encode(stamp_ns, row),
                                 stamp_ns)


def _checked(signals: Mapping[str, ArrayLike]) -> Signals:
    for name in signals:
        if name != 't_ns' and not is_key(name):
            raise UnknownNameError.among('signal', name, ('t_ns', *KEYS))
    arrays: Signals = {name: np.asarray(values) for name, values in signals.items()}
    if len({array.shape for array in arrays.values()}) > 1 or any(
            array.ndim != 1 for array in arrays.values()):
        shapes = ', '.join(f'{name} {array.shape}' for name, array in arrays.items())
        raise SignalShapeError(f'signals must be arrays of one shape (N,), got {shapes}')
    for needed in ('t', 'wrench.', 'joint.'):
        has_efforts = needed == 'wrench.' and any(map(is_effort, arrays))
        if not has_efforts and not any(name.startswith(needed) for name in arrays):
            raise RecordingError(
                f'signals must have time, a force and a joint, got {", ".join(arrays)}; add '
                f'{needed}{"NAME" if needed == "joint." else "force.z" * (needed != "t")}')
    t = arrays.pop('t', None)
    if 't_ns' not in arrays:
        arrays['t_ns'] = np.rint(np.asarray(t, np.float64) * 1e9).astype(np.int64)
    return {name: array.astype(np.int64 if name == 't_ns' else np.float64)
            for name, array in arrays.items()}


def write_csv(path: Path, signals: Mapping[str, NDArray[Any]]) -> None:
    """Write signals as CSV that reads back without loss; NaN becomes an empty cell."""
    try:
        with open(path, 'x', encoding='utf-8') as stream:
            _write_rows(stream, signals)
    except FileExistsError as error:
        raise RecordingError(
            f'{path} exists and recordings are never overwritten; choose another output'
        ) from error
    except OSError as error:
        raise RecordingError(f'cannot write {path}: {error.strerror}') from error


def _write_rows(stream: TextIO, signals: Mapping[str, NDArray[Any]]) -> None:
    used = {name: values for name, values in signals.items()
            if values.dtype.kind == 'i' or not np.isnan(values).all()}
    stream.write(','.join(used) + '\n')
    for row in zip(*(values.tolist() for values in used.values())):
        stream.write(','.join('' if cell != cell else repr(cell) for cell in row) + '\n')


def signals_of_recording(reader: RecordingReader, source: RecordingSource) -> Signals:
    """
    Read wrench, joints and reference as arrays on common rows.

    reader: the recording
    source: its topics
    Returns signals (N,): as of `read_table`, without 't'. Of equal stamps of a topic, the first
    counts
    """
    joints, references = _Joints('joint'), _Joints('reference')
    decode = {source.joint_states: joints.decode, source.wrench: ForceTorqueDecoder().decode,
              source.reference_trajectory: references.decode}
    there = {canonical(topic) for topic in reader.topics()}
    rows, refused = gather(reader, {topic: decode[topic] for topic in decode if (
        topic == source.joint_states or canonical(topic) in there)})
    names = {source.joint_states: joints.names, source.wrench: FORCES,
             source.reference_trajectory: references.names}
    for topic, (stamps, _) in rows.items():
        if topic != source.reference_trajectory and not stamps:
            raise RecordingError(
                f'no usable message on {topic} in {reader.path}{refused.get(topic, "")}')
    stamps_ns = np.unique(np.concatenate([np.array(stamps, np.int64)
                                          for stamps, _ in rows.values()]))
    signals: Signals = {'t_ns': stamps_ns}
    for topic in (source.wrench, source.joint_states, source.reference_trajectory):
        if topic in rows and rows[topic][0]:
            own_ns, first = np.unique(np.array(rows[topic][0], np.int64), return_index=True)
            places = np.searchsorted(stamps_ns, own_ns)
            for name, column in zip(names[topic], np.array(rows[topic][1]).reshape(
                    -1, len(names[topic]))[first].T):
                signals[name] = np.full(len(stamps_ns), np.nan)
                signals[name][places] = column
    if source.wrench not in rows and not any(
            np.isfinite(values).any() for name, values in signals.items() if is_effort(name)):
        next(iter(reader.messages([source.wrench])))  # says what is there instead
    return signals


class _Joints:
    """Rows of all joints of the first message: positions, then each rate."""

    def __init__(self, kind: str) -> None:
        self.names: Sequence[str] = ()
        self._kind = kind
        self._decode: Any = None

    def decode(self, raw: bytes) -> tuple[int, tuple[float, ...]]:
        if self._decode is None:
            joints = _joint_names(raw) or ['x']
            self.names = [f'{self._kind}.{joint}{rate}' for rate in (
                '', *('.' + rate for rate in RATES[self._kind])) for joint in joints]
            self._decode = _joint_rows(joints) if self._kind == 'joint' else _points(joints)
        found: tuple[int, tuple[float, ...]] = self._decode(raw)
        return found


def _joint_names(raw: bytes) -> list[str]:
    try:
        cursor = CdrCursor(raw)
        cursor.skip(8)
        cursor.text()  # frame
        return cursor.texts()
    except ValueError as error:
        raise MessageError('malformed', f'{len(raw)} bytes name no joints: {error}') from error


def _joint_rows(joints: Sequence[str]) -> Any:
    decoder = JointsDecoder(joints if len(joints) > 1 else [''])

    def decode(raw: bytes) -> tuple[int, tuple[float, ...]]:
        stamp_ns, positions, velocities = decoder.decode(raw)
        arm = decode_arm(raw)
        efforts = dict(zip(arm.names or ('x',), arm.effort.tolist()))
        return stamp_ns, (*positions, *velocities, *(efforts.get(name, nan) for name in joints))

    return decode


def _points(joints: Sequence[str]) -> Any:
    decoders = [TrajectoryDecoder(joint) for joint in (joints if len(joints) > 1 else [''])]

    def decode(raw: bytes) -> tuple[int, tuple[float, ...]]:
        points = [decoder.decode(raw) for decoder in decoders]
        return points[0].stamp_ns, tuple(
            value for values in zip(*(point[1:] for point in points)) for value in values)

    return decode
