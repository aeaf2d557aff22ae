# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""An arm in recordings: its parameters, its description and the signals of its contact axis."""

from dataclasses import replace
from itertools import repeat
from math import isnan, nan
from typing import Any, Callable, Iterator, Mapping, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .arm_efforts import EffortDecoder
from .arm_kinematics import (
    ArmFrames, described_in_file, kinematics_of, kinematics_of_frames, static_of_parameters)
from .axes import Moment
from .checks.axes_checks import foreign_axes, Loads
from .events import DESCRIPTION, EstimationEvent, READY, START, STATIC
from .parameters import EstimationParameters
from .tracked_zero import tracked_zero
from ..exceptions import RecordingError
from ..kinematics.contact_kinematics import ArmSample, ContactKinematics
from ..kinematics.frame_tree import StampedTransform, TransformsDecoder
from ..kinematics.parameters import JOINT_EFFORTS, TRACKED
from ..kinematics.robot_model import RobotModel
from ..kinematics.transform_model import MovingFrames, NUMBERS
from ..parameters import specifications
from ..recordings import RecordingReader
from ..recordings.decoding import decode_string, ForceTorqueDecoder, JointsDecoder
from ..recordings.recorded_signals import (
    read_rows, read_signals, RecordedSignals, reference_rows, Row, Signal, tare_of)
from ..recordings.source import canonical, from_metadata, RecordingSource
from ..signals.filters import smoothed_rate
from ..signals.joint_merging import JointMerger
from ..signals.stamp_screen import BEFORE_ANY


_OF_ARMS = ('kinematics.', 'contact.', 'force_sensor.', 'tool.', 'synchronisation.',
            'physics.tool_inertia.', 'force_sign', 'frame_id', 'pose_source', 'wrench_source',
            'joint_torques_std')
BEFORE_ANY_SAMPLE = Moment(0, BEFORE_ANY)
_FILE = 'robot_description_file'


def recorded_parameters(
    reader: RecordingReader, source: RecordingSource, chosen: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the parameters at start that a recording holds."""
    known = {spec.name for spec in specifications(EstimationParameters)} - {_FILE}
    recorded = from_metadata(reader.metadata()) or _at_start(reader, source)
    recorded = {name: value for name, value in recorded.items() if name in known}
    if 'axis' in chosen:  # chosen by the user, not recorded by the node
        recorded = {k: v for k, v in recorded.items()
                    if not k.startswith(('further_axes.', 'matrix_estimator'))}
    return recorded


def arm_parameters(
    reader: RecordingReader, source: RecordingSource, chosen: Mapping[str, Any]
) -> dict[str, Any]:
    """Return those of the recorded and chosen parameters that concern an arm and its sensor."""
    every = {**recorded_parameters(reader, source, chosen), **chosen}
    return {k: v for k, v in every.items() if k.startswith((*_OF_ARMS, _FILE))}


def _at_start(reader: RecordingReader, source: RecordingSource) -> dict[str, Any]:
    event = next(recorded_events(reader, source), None)
    return dict(event.parameters) if event and event.kind == START else {}


def recorded_events(reader: RecordingReader, source: RecordingSource) -> Iterator[EstimationEvent]:
    """Yield the events of the node that a recording holds; none without their topic."""
    if canonical(source.events) in {canonical(name) for name in reader.topics()}:
        for message in reader.messages([source.events]):
            yield EstimationEvent.from_text(decode_string(message.data))


def recorded_static(
    reader: RecordingReader, source: RecordingSource
) -> list[StampedTransform]:
    """Return the static transforms of a recording."""
    events = [event for event in recorded_events(reader, source) if event.kind == STATIC]
    if events:
        return [one for event in events if event.moment == BEFORE_ANY_SAMPLE
                for one in static_of_parameters(event.parameters)]
    if canonical(source.tf_static) not in {canonical(name) for name in reader.topics()}:
        return []
    decoder = TransformsDecoder()
    return [one for message in reader.messages([source.tf_static])
            for one in decoder.decode(message.data)]


def refused_at_start(reader: RecordingReader, source: RecordingSource) -> Mapping[str, Any]:
    """Return what the node had refused before it knew the arm; see `StartUp`."""
    for event in recorded_events(reader, source):
        if event.kind == READY:
            return event.parameters
    return {}


def recorded_description(reader: RecordingReader, source: RecordingSource) -> str:
    """Return the robot description of a recording."""
    for event in recorded_events(reader, source):
        if event.kind == DESCRIPTION:
            return str(event.parameters['text'])
    there = {canonical(name) for name in reader.topics()}
    if canonical(source.robot_description) in there:
        for message in reader.messages([source.robot_description]):
            return decode_string(message.data)
    raise RecordingError(
        f'{reader.path} has no robot description on {canonical(source.robot_description)}, which '
        'kinematics.tip needs; give the URDF as robot_description_file in --params, or record the '
        'topic'
    )


Array = NDArray[np.float64]

_BLOCK_NS = 500_000_000  # over which loads of the sensor are averaged
_SMOOTHED_S = 0.02  # over which the acceleration of the tool is taken


class Motions(NamedTuple):
    """The arm, the topic of its motion, what reads it, and the number of its coordinates."""

    arm: ContactKinematics
    topic: str
    decode: Callable[[bytes], Any]
    coordinates: int


def read_contact_signals(
    reader: RecordingReader, source: RecordingSource, parameters: EstimationParameters,
    axis: str, joint: str, most_samples: int | None = None,
) -> RecordedSignals:
    """Read motion, force and reference along the contact axis, of an arm or of a single joint."""
    if parameters.kinematics.tip:
        signals = read_arm_signals(reader, source, parameters, most_samples)
    else:
        signals = read_signals(
            reader, source, axis, joint, most_samples, parameters.frame_id)
        signals.wrench.values[:] *= parameters.force_sign
    if parameters.force_sensor.zero == TRACKED:
        wrench, motion = signals.wrench, signals.joint_states
        x = np.interp(wrench.stamp_ns, motion.stamp_ns, motion.values[0])
        wrench.values[0] -= tracked_zero(wrench.stamp_ns, x, wrench.values[0], parameters)
    if not source.tare:
        return signals
    tare = tare_of(1e-9 * (signals.wrench.stamp_ns - signals.wrench.stamp_ns[0]),
                   signals.wrench.values[0], source.tare)
    signals.wrench.values[0] -= tare.force
    return replace(signals, tare=tare)


def read_arm_signals(
    reader: RecordingReader, source: RecordingSource, parameters: EstimationParameters,
    most_samples: int | None = None,
) -> RecordedSignals:
    """
    Read motion, force and reference along the normal of an arm.

    The same `ContactKinematics` as on line gives x at the stamps of the joints, and F_e at the
    stamps of the wrench, for which the joints are interpolated. A normal given in the tip's frame
    is that of the instant at which the arm presses most. The inertia of a tool of known mass
    (`physics.tool_inertia.mass`) is taken out, as on line: F_e = F + mass a.
    """
    frames = ArmFrames()
    frames.add_static(recorded_static(reader, source))
    arm, motion_topic, motions, count = (
        _from_transforms if parameters.pose_source == 'tf' else _from_joints
    )(reader, source, parameters, frames)
    wrenches = ForceTorqueDecoder()
    decode: dict[str, Callable[[bytes], Any]] = {
        source.wrench: wrenches.decode, motion_topic: motions,
        source.reference_trajectory: reference_rows(''),
    }
    if parameters.wrench_source == JOINT_EFFORTS:
        del decode[source.wrench]
        both, reference = read_rows(reader, source, decode, (7 + 2 * count, 4), most_samples)
        wrench, motion = (Signal(both.stamp_ns, both.values[part])
                          for part in (slice(6), slice(6, -1)))
        error = float(np.sqrt(np.mean(np.square(both.values[-1]))))
    else:
        wrench, motion, reference = read_rows(
            reader, source, decode, (6, 2 * count, 4), most_samples)
        error = 0.0
        frames.place_sensor(arm, parameters.force_sensor.frame or wrenches.frame_id)
    usable, at_wrenches = _interpolated(
        motion, wrench.stamp_ns, parameters.synchronisation.maximum_gap_s)
    if not usable.any():
        raise RecordingError(
            f'no wrench of {reader.path} has joint states around its stamp; check the clocks of '
            'both topics'
        )
    samples = [ArmSample(0, *pair) for pair in zip(
        at_wrenches.T.tolist(), wrench.values[:, usable].T.tolist())]
    _hold_where_pressing_most(arm, samples)
    force, loads = np.zeros(len(samples)), np.zeros((len(samples), 9))
    for k, sample in enumerate(samples):
        force[k], loads[k] = arm.contact(sample).force, arm.loads(sample.wrench)
    x = np.array([arm.motion(row)[2:] for row in motion.values.T.tolist()]).T
    stamps_ns, mass = wrench.stamp_ns[usable], parameters.physics.tool_inertia.mass
    if not isnan(mass):
        force += mass * _acceleration(Signal(motion.stamp_ns, x), stamps_ns)
    return RecordedSignals(
        Signal(stamps_ns, force[None]), Signal(motion.stamp_ns, x), reference, arm.model.base,
        foreign_axes=_foreign_axes(loads, stamps_ns, parameters), sensor_error=error)


def _from_joints(
    reader: RecordingReader, source: RecordingSource, parameters: EstimationParameters,
    frames: ArmFrames,
) -> Motions:
    """Read the joints of an arm with a robot description."""
    description = described_in_file(parameters) or recorded_description(reader, source)
    arm = kinematics_of(parameters, description)
    assert isinstance(arm.model, RobotModel)
    if parameters.wrench_source == JOINT_EFFORTS:
        efforts = EffortDecoder(arm, description, parameters)

        def decode_both(data: bytes) -> Row | None:
            found = efforts.decode(data)
            return found and (found.stamp_ns, (
                *found.wrench, *found.motion, float(np.linalg.norm(arm.normal @ found.errors))))

        return Motions(arm, source.joint_states, decode_both, len(arm.model.joint_names))
    joints = JointsDecoder(arm.model.joint_names, every=False)
    merger = JointMerger(arm.model.continuous)

    def decode(data: bytes) -> Row | None:
        return merger.add(*joints.decode(data))

    return Motions(arm, source.joint_states, decode, len(arm.model.joint_names))


def _from_transforms(
    reader: RecordingReader, source: RecordingSource, parameters: EstimationParameters,
    frames: ArmFrames,
) -> Motions:
    """Read the poses of the moving frames of an arm in tf."""
    decoder = TransformsDecoder()
    for message in reader.messages([source.tf]):
        if frames.tree.add_moving(decoder.decode(message.data)) and frames.tree.path(
                parameters.kinematics.base, parameters.kinematics.tip):
            break
    arm = kinematics_of_frames(parameters, frames.tree)
    moving = MovingFrames(
        arm.model.joint_names, parameters.synchronisation.time_jump_s)

    def decode(data: bytes) -> list[Row]:
        return [(stamp_ns, (*poses, *repeat(nan, len(poses))))
                for stamp_ns, poses in moving.add(decoder.decode(data))]

    return Motions(arm, source.tf, decode, NUMBERS * len(arm.model.joint_names))


def _acceleration(motion: Signal, stamps_ns: NDArray[np.int64]) -> Array:
    """Return the acceleration along the normal, smoothed over 20 ms, at given stamps [m/s^2]."""
    (x, v), t = motion.values, (motion.stamp_ns - stamps_ns[0]) * 1e-9
    if not np.isfinite(v).all():
        v = np.gradient(x, t)
    at = (stamps_ns - stamps_ns[0]) * 1e-9
    period = float(np.median(np.diff(at)))
    even = np.arange(0.0, at[-1] + period, period)
    return np.interp(at, even, smoothed_rate(np.interp(even, t, v), period, _SMOOTHED_S))


def _interpolated(
    motion: Signal, stamps_ns: NDArray[np.int64], longest_s: float
) -> tuple[NDArray[np.bool_], Array]:
    """Return which stamps lie between near joint states, and the motion at these."""
    after = np.searchsorted(motion.stamp_ns, stamps_ns)
    inside = np.clip(after, 1, len(motion) - 1) if len(motion) > 1 else np.zeros_like(after)
    gap_ns = motion.stamp_ns[inside] - motion.stamp_ns[inside - 1]
    first, last = motion.stamp_ns[0], motion.stamp_ns[-1]
    usable = (stamps_ns >= first) & (stamps_ns <= last) & (gap_ns <= longest_s * 1e9)
    t, times = (stamps_ns[usable] - first) * 1e-9, (motion.stamp_ns - first) * 1e-9
    return usable, np.array([np.interp(t, times, row) for row in motion.values])


def _foreign_axes(
    table: Array, stamps_ns: NDArray[np.int64], parameters: EstimationParameters
) -> str:
    """Return what loads (N, 9) say of the axes of the wrench, as on line; '': nothing."""
    loads = Loads()
    for block in np.split(table, np.flatnonzero(np.diff(stamps_ns // _BLOCK_NS)) + 1):
        loads.add(block)
    return foreign_axes(loads.kept, parameters.contact.force_noise, parameters) or ''


def _hold_where_pressing_most(arm: ContactKinematics, samples: list[ArmSample]) -> None:
    pressing = [-arm.contact(sample).force for sample in samples]
    arm.contact(samples[int(np.argmax(pressing))])
    arm.held = True
