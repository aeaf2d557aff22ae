# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The signals of a recording as arrays, each with its own stamps, and the zero of the force."""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from itertools import islice
import re
from typing import Callable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .cdr import header_stamp_ns
from .decoding import (
    FORCE_OF_AXIS, JointStateDecoder, TrajectoryDecoder, WrenchDecoder, WrenchReading,
)
from .reading import RecordingReader
from .source import canonical, RecordingSource
from ..exceptions import MessageError, RecordingError

Array = NDArray[np.float64]

FIRST = 'first-free-flight'
_WINDOW_S = 0.5  # of free flight, as a tare on line needs
_QUIET = 3.0  # times the noise between samples
_MAD = 0.6745  # of the standard deviation, for normal noise


class Tare(NamedTuple):
    """Force taken as zero [N], and the span of its median [s from the first wrench]."""

    force: float
    begin_s: float
    end_s: float

    def __str__(self) -> str:
        """Return what was done."""
        return (f'tare: {self.force:.4g} N subtracted from the force, its median from '
                f'{self.begin_s:.4g} to {self.end_s:.4g} s')


def tare_of(t: Array, force: Array, tare: str) -> Tare:
    """Measure the zero of the force [N] over `tare`, a span A:B [s] or FIRST."""
    if tare == FIRST:
        begin, end = _first_free_flight(t, force)
    else:
        match = re.fullmatch(r'([\d.]*):([\d.]*)', tare)
        try:
            begin, end = (float(part) if part else edge for part, edge in zip(
                match.groups() if match else ('?', '?'), (0.0, float(t[-1]))))
        except ValueError as error:
            raise RecordingError(
                f'--tare must be {FIRST}, tracked, or a span of free flight A:B in seconds from '
                f'the first wrench, got {tare!r}; example: 0.2:1.5') from error
    inside = (t >= begin) & (t <= end)
    if not inside.any():
        raise RecordingError(
            f'--tare {tare}: no wrench from {begin:g} to {end:g} s; the recording lasts '
            f'{t[-1]:.4g} s')
    return Tare(float(np.median(force[inside])), begin, end)


def _first_free_flight(t: Array, force: Array) -> tuple[float, float]:
    """
    Find the first windows in which the force is quiet, and presses less than half as it can.

    F_e is negative while pressing: free flight is the upper of two levels, even where zero steps.
    """
    edges = np.searchsorted(t, np.arange(0.0, t[-1], _WINDOW_S))
    windows = [(int(a), int(b)) for a, b in zip(edges[:-1], edges[1:]) if b - a > 2]
    noise = float(np.median(np.abs(np.diff(force)))) / (_MAD * np.sqrt(2.0))
    floor = 1e-3 * float(np.ptp(force))
    means = np.array([force[a:b].mean() for a, b in windows])
    quiet = np.array([force[a:b].std() <= max(_QUIET * noise, floor) for a, b in windows], bool)
    if not quiet.any():
        raise RecordingError(
            f'--tare {FIRST} found no {_WINDOW_S:g} s in which the force is steady; give a span '
            'of free flight as --tare A:B in seconds from the first wrench')
    low, high = float(np.min(force)), float(means[quiet].max())
    free = quiet & (means > 0.5 * (low + high))
    first = int(np.argmax(free))
    last = first + int(np.argmin([*free[first:], False])) - 1
    return float(t[windows[first][0]]), float(t[windows[last][1] - 1])


Row = tuple[int, Sequence[float]]
_RATE_SAMPLES = 2000


@dataclass(frozen=True)
class Signal:
    """One topic of the contact axis, sorted by stamp, without non-finite samples."""

    stamp_ns: NDArray[np.int64]  # (N,) header stamps [ns], strictly increasing
    # (n, N) wrench: F_e [N]; joint_states: x [m] and its rate [m/s], NaN where not recorded;
    # reference_trajectory: x_r [m], its rate [m/s] and acceleration [m/s^2], F_r [N]
    values: NDArray[np.float64]
    back_ns: int = 0  # by how much a stamp lay before that of an earlier message, at most [ns]

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.stamp_ns)


@dataclass(frozen=True)
class RecordedSignals:
    """The signals of the contact axis in a recording."""

    # wrench, joint_states: never empty
    wrench: Signal
    joint_states: Signal
    reference_trajectory: Signal  # empty where none was recorded
    frame_id: str  # frame of the wrench
    foreign: int = 0  # number of wrenches left out, since they have another frame
    tare: Tare | None = None  # what was subtracted from the force
    foreign_axes: str = ''  # of an arm: that the wrench is in other axes than configured
    sensor_error: float = 0.0  # standard deviation of errors of the force other than noise [N]


def read_signals(
    reader: RecordingReader, source: RecordingSource, axis: str = 'x', joint: str = '',
    most_samples: int | None = None, frame_id: str = '',
) -> RecordedSignals:
    """Read wrench, joint and reference of the contact axis; '': the frame of the first wrench."""
    force = _ForceOfFrame(axis, frame_id)
    decode_joints = JointStateDecoder(joint).decode

    def motion(data: bytes) -> Row:
        stamp_ns, *values = decode_joints(data)
        return stamp_ns, tuple(values)

    wrench, joints, reference = read_rows(
        reader, source, {source.wrench: force, source.joint_states: motion,
                         source.reference_trajectory: reference_rows(joint)},
        (1, 2, 4), most_samples)
    if force.others and not force.changes:
        raise RecordingError(
            f'the force of {reader.path} is constant along {axis}, but changes along '
            f'{" and ".join(sorted(force.others))}; set axis (--axis) to that of the contact')
    return RecordedSignals(wrench, joints, reference, force.frame_id, force.foreign)


def read_rows(
    reader: RecordingReader, source: RecordingSource,
    decode: Mapping[str, Callable[[bytes], Row | list[Row] | None]], widths: Sequence[int],
    most_samples: int | None = None,
) -> list[Signal]:
    """Read wrench, joints and reference."""
    asked = [name for name in decode if name != source.reference_trajectory]
    recorded = {canonical(name) for name in reader.topics()}
    if canonical(source.reference_trajectory) in recorded:
        asked.append(source.reference_trajectory)
    rows, refused = gather(reader, {name: decode[name] for name in asked}, most_samples)
    signals = [stacked(*rows.get(name, (array('q'), array('d'))), width)
               for name, width in zip(decode, widths)]
    for name, signal in zip(list(decode)[:-1], signals):
        if not len(signal):
            raise RecordingError(
                f'no usable message on {name} in {reader.path}: expected finite values with '
                f'stamps, got none{refused.get(name, "")}; check topic, axis and joint')
    return signals


def gather(
    reader: RecordingReader,
    decode: Mapping[str, Callable[[bytes], Row | list[Row] | None]],
    most_samples: int | None = None,
) -> tuple[dict[str, tuple[array[int], array[float]]], dict[str, str]]:
    """
    Decode topics in one pass.

    most_samples: of the first topic, at which it ends
    Returns rows: stamps [ns] and values of each topic, sample by sample
    Returns refused: why the last message that could not be decoded was refused, by topic
    """
    # Arrays of plain numbers: hours at 1 kHz are millions of messages.
    rows = {name: (array('q'), array('d')) for name in decode}
    refused: dict[str, str] = {}
    first = rows[next(iter(decode))][0]
    for topic, _, data in reader.messages(list(decode)):
        try:
            found = decode[topic](data)
        except MessageError as error:
            refused[topic] = f': {error}'
            continue
        stamps, values = rows[topic]
        for row in found if isinstance(found, list) else [found] if found else ():
            stamps.append(row[0])
            values.extend(row[1])
        if len(first) == most_samples:
            break
    return rows, refused


def wrench_rate(reader: RecordingReader, topic: str) -> float:
    """
    Measure the rate of the wrench, or of what it comes from, by the stamps of its messages.

    Returns rate: inverse of the median period of 2000 messages [Hz]; NaN where stamps do not
    increase
    """
    first = islice(reader.messages([topic]), _RATE_SAMPLES)
    stamps = [header_stamp_ns(message.data) or 0 for message in first]
    period_ns = float(np.median(np.diff(stamps))) if len(stamps) > 1 else 0.0
    return 1e9 / period_ns if period_ns > 0.0 else float('nan')


class _ForceOfFrame:
    """Read the force of wrenches of one frame; count the others as `foreign`."""

    def __init__(self, axis: str, frame_id: str) -> None:
        self.frame_id, self.foreign = frame_id, 0
        self._wrenches, self._force_of = WrenchDecoder(), FORCE_OF_AXIS[axis]
        self._first: WrenchReading | None = None
        self.changes, self.others = False, set[str]()  # whether, and the axes whose force does

    def __call__(self, data: bytes) -> Row:
        reading = self._wrenches.decode(data)
        self.frame_id = self.frame_id or reading.frame_id
        if reading.frame_id != self.frame_id:
            self.foreign += 1
            raise MessageError(
                'wrench_frame_id',
                f'expected frame {self.frame_id!r}, got {reading.frame_id!r}; set frame_id')
        if not self.changes:
            first = self._first = self._first or reading
            self.changes = self._force_of(reading) != self._force_of(first)
            self.others |= {axis for axis, force_of in FORCE_OF_AXIS.items()
                            if force_of(reading) != force_of(first)}
        return reading.stamp_ns, (self._force_of(reading),)


def reference_rows(joint: str) -> Callable[[bytes], Row]:
    """Return the function that reads a reference of the contact axis."""
    references = TrajectoryDecoder(joint)

    def reference(data: bytes) -> Row:
        stamp_ns, x, *rest = references.decode(data)
        # Missing entries of a reference are 0: no feed-forward, no desired force.
        return stamp_ns, (x, *(0.0 if value != value else value for value in rest))

    return reference


def stacked(stamps: array[int], rows: array[float], width: int) -> Signal:
    """
    Return samples as a signal, without non-finite ones and all but the first of equal stamps.

    stamps: stamps of N samples [ns], in any order
    rows: their values, sample by sample
    width: values of each sample; one whose first is not finite is left out
    """
    stamp_ns = np.array(stamps, np.int64)
    values = np.array(rows, np.float64).reshape(-1, width)
    finite = np.isfinite(values[:, 0])
    in_order = stamp_ns[finite]
    stamp_ns, first = np.unique(in_order, return_index=True)
    back = np.max(np.maximum.accumulate(in_order) - in_order, initial=0)
    return Signal(stamp_ns, values[finite][first].T, int(back))
