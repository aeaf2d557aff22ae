# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A recording and its signals, each with stamps of its own, and how they are read."""

from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any, Mapping, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...exceptions import RecordingError, UnknownNameError
from ...parameters import build
from ...physics.numeric import Array
from ...pipeline.parameters import EstimationParameters
from ...pipeline.recorded_arm import arm_parameters, read_contact_signals
from ...recordings import RecordingReader
from ...recordings.decoding import FORCE_OF_AXIS
from ...recordings.recorded_signals import RecordedSignals, Tare
from ...recordings.source import RecordingSource
from ...texts import printable

LEAST_SAMPLES = 50
_ABSURD = 1e30  # in any unit


class Signals(NamedTuple):
    """The content of a recording; times are counted from the first wrench [s]."""

    # wrench_t, force (N,): measured F_e [N]
    wrench_t: Array
    force: Array
    # joint_t, position (J,): x [m]
    joint_t: Array
    position: Array
    reference_t: Array  # (R,) empty without a reference trajectory
    reference: Array  # (4, R) x_r [m], its rate [m/s] and acceleration [m/s^2], F_r [N]; no NaN


@dataclass(frozen=True, eq=False)
class Recording:
    """A recording to be diagnosed."""

    name: str  # for texts
    signals: Signals  # as recorded
    # by how much a stamp lay before that of an earlier message, at most [s]
    stamps_back_s: float = 0.0
    damage: str = ''  # what of the file was not read, and why; '' if all was
    rests_count: bool = True  # whether the stretches count in which a drive is held at rest
    tare: Tare | None = None  # what was subtracted from the force
    simulated: bool = False  # whether a simulator wrote it, whose sensors err by noise alone
    foreign_axes: str = ''  # of an arm: that the wrench is in other axes than configured
    # standard deviation of the errors of the force that are no noise, of torques of joints [N]
    sensor_error: float = 0.0


def signals_of(recorded: RecordedSignals) -> Signals:
    """Convert recorded stamps to seconds from the first wrench."""
    start = int(recorded.wrench.stamp_ns[0])

    def seconds(stamps: NDArray[np.int64]) -> Array:
        return np.asarray((stamps - start) * 1e-9, np.float64)

    wrench, joints = recorded.wrench, recorded.joint_states
    reference = recorded.reference_trajectory
    return Signals(
        seconds(wrench.stamp_ns), wrench.values[0], seconds(joints.stamp_ns), joints.values[0],
        seconds(reference.stamp_ns), reference.values)


def without_reference(recording: Recording) -> Recording:
    """Return a recording of which the contact alone is diagnosed, whatever moves the tip."""
    return replace(recording, signals=recording.signals._replace(
        reference_t=np.zeros(0), reference=np.zeros((4, 0))))


def check_signals(signals: Signals) -> None:
    """Check that the signals have enough samples, are finite and not constant."""
    for name, stamps in (('wrench', signals.wrench_t), ('joint_states', signals.joint_t)):
        if len(stamps) < LEAST_SAMPLES:
            raise RecordingError(
                f'{name} must have at least {LEAST_SAMPLES} different stamps, got {len(stamps)}; '
                'stamp every header, record longer or at a higher rate, or take the time of '
                'reception with --stamps received; give a table a rate with --columns t=500Hz')
    for name, values in (
        ('wrench', signals.force), ('joint_states', signals.position),
        ('reference_trajectory', signals.reference),
    ):
        if not np.isfinite(values).all():
            raise RecordingError(
                f'{name} must have finite values only, got NaN or infinity; remove these samples')
        absurd = np.count_nonzero(np.abs(values) > _ABSURD)
        if absurd:
            raise RecordingError(
                f'{name} must have possible values only, got {absurd} beyond {_ABSURD:g}; remove '
                'these samples')
    for name, values in (('wrench', signals.force), ('joint_states', signals.position)):
        if float(np.ptp(values)) == 0.0:
            raise RecordingError(
                f'{name} is constant at {values[0]:g}, expected a signal that changes; check '
                'topic, axis and joint; under a constant load record the measured force, not the '
                'command, and the loading')


_APART = 1.0 - 1e-9  # ramps that meet must not overlap by rounding
_SMOOTH = 0.9  # of the changes of x_r, that follow another one: else it is a staircase


def with_held_reference(recording: Recording) -> Recording:
    """Let a robot hold its reference."""
    s = recording.signals
    if len(s.reference_t) < 2:
        return recording
    reference = held_at(s.wrench_t, s.reference_t, s.reference)
    return replace(recording, signals=s._replace(reference_t=s.wrench_t, reference=reference))


def held_at(t: Array, stamps: Array, values: Array) -> Array:
    """Sample values that are held from stamp to stamp."""
    periods = np.diff(stamps, prepend=stamps[0] - (stamps[1] - stamps[0]))
    width = np.minimum(periods, float(np.median(np.diff(t))))
    width[:-1] = _APART * np.minimum(width[:-1], width[1:])
    corners = np.column_stack((stamps - 0.5 * width, stamps + 0.5 * width)).ravel()
    before = np.concatenate((values[:, :1], values[:, :-1]), axis=1)
    levels = np.stack((before, values), axis=2).reshape(len(values), -1)
    return np.array([np.interp(t, corners, row) for row in levels])


def lacks_rates(signals: Signals) -> bool:
    """Return whether a reference moves smoothly but has no rates."""
    if len(signals.reference_t) < 3 or signals.reference[1:3].any():
        return False
    moves = np.diff(signals.reference[0]) != 0.0
    following = np.count_nonzero(moves[1:] & moves[:-1])
    return bool(following > _SMOOTH * np.count_nonzero(moves) > 0.0)


def with_reference_rates(recording: Recording) -> Recording:
    """Differentiate a reference that lacks its rates."""
    s = recording.signals
    if not lacks_rates(s):
        return recording
    x_r, _, _, F_r = s.reference
    rate = np.gradient(x_r, s.reference_t)
    rows = np.array([x_r, rate, np.gradient(rate, s.reference_t), F_r])
    return replace(recording, signals=s._replace(reference=rows))


def read_recording(
    path: str | PathLike[str], *, topics: Mapping[str, str] | None = None, axis: str = 'x',
    joint: str = '', parameters: Mapping[str, Any] | None = None,
    most_samples: int | None = None, **reading: Any,
) -> Recording:
    """
    Read the signals of a recording.

    Parameters
    ----------
    path : str or path-like
        An `.mcap` file, a rosbag2 folder, or a CSV, Parquet or MAT file.
    topics : mapping of str to str, optional
        Recorded topic names by 'wrench', 'joint_states' and 'reference_trajectory'. A topic that
        is not given has that name.
    axis : {'x', 'y', 'z'}
        Force axis of the wrench.
    joint : str
        Joint of the contact axis; '' if the recording has only one.
    parameters : mapping, optional
        Parameters of `estimator_node` by dotted name, of which those of an arm and its tool and of
        the force's sign are used; they take precedence over recorded ones.
    most_samples : int, optional
        Number of wrenches after which reading stops, a bound of the memory; all by default.
    **reading
        Further attributes of `RecordingSource`, such as columns={'t': 'time'}, units=('mm',).

    Returns
    -------
    recording : Recording
        Name and signals, time in seconds from the first wrench.

    Raises
    ------
    RecordingError
        If the recording cannot be read or lacks wrenches or joint states.
    UnknownNameError
        If `axis` or a key of `topics` is unknown.

    """
    if axis not in FORCE_OF_AXIS:
        raise UnknownNameError.among('axis', axis, FORCE_OF_AXIS)
    source = RecordingSource.of_topics(topics or {}, **reading)
    reader = RecordingReader(str(path), source)
    arm = build(EstimationParameters, arm_parameters(reader, source, parameters or {}))
    signals = read_contact_signals(reader, source, arm, axis, joint, most_samples)
    back = max(signals.wrench.back_ns, signals.joint_states.back_ns)
    return Recording(printable(Path(path).name), signals_of(signals), 1e-9 * back,
                     _damage(reader, signals), tare=signals.tare,
                     foreign_axes=signals.foreign_axes, sensor_error=signals.sensor_error)


def _damage(reader: RecordingReader, signals: RecordedSignals) -> str:
    """Say what of a file could not be read or used; '' if all was."""
    if signals.foreign:
        return (f'{signals.foreign} wrenches are not in the frame {signals.frame_id!r} and were '
                'left out; frame_id chooses another')
    if reader.damaged_chunks or reader.truncated:
        cause = ('it ends within its data' if not reader.damaged_chunks else
                 f'{reader.damaged_chunks} stretch(es) of it cannot be read')
        return f'the file is damaged: {cause}; end the recorder before copying its file'
    return ''
