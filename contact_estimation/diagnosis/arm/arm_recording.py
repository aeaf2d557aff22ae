# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recordings of whole arms: positions and efforts of all joints on one grid of time."""

from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
import re
from typing import Any, Mapping, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from ...exceptions import MessageError, RecordingError
from ...kinematics.arm_dynamics import ArmDynamics, Outside
from ...kinematics.tool_load import load_map
from ...parameters import build
from ...physics.numeric import Array, Flags
from ...pipeline.parameters import EstimationParameters
from ...pipeline.recorded_arm import arm_parameters
from ...recordings import RecordingReader
from ...recordings.decoding import ArmReading, decode_arm, ForceTorqueDecoder
from ...recordings.source import canonical, RecordingSource

_FELT_N = 1.0
_PRESSING = 90.0  # percentile of the force, beyond which its direction is the normal


@dataclass(frozen=True, eq=False)
class ArmWrench:
    """Measured wrenches of an arm at the times of its joint states."""

    frame: str  # link of the sensor
    measured: Array  # (N, 6) as published [N], [N m]
    # of sensor and tool: `force_sign`, `force_sensor.*`, `tool.*`
    parameters: EstimationParameters

    def outside(self, arm: ArmDynamics, q: Array) -> Outside:
        """Return what acts on the arm: without the tool's weight, in axes of the sensor's link."""
        sensor = self.parameters.force_sensor
        mount, axes = Rotation.from_euler('xyz', sensor.rpy).as_matrix(), arm.axes(q, self.frame)
        turned = axes @ mount
        both = self.parameters.force_sign * self.measured.reshape(-1, 2, 3)
        if sensor.axes == 'base':
            both = both @ turned
        load, bias = load_map(self.parameters.tool)
        down = turned.transpose(0, 2, 1) @ arm.model.gravity.linear
        own = both.reshape(-1, 6) - bias - down @ load.T
        return Outside(self.frame, (own.reshape(-1, 2, 3) @ mount.T).reshape(-1, 6))


def pressed_along(arm: ArmDynamics, q: Array, outside: Outside) -> Array:
    """Return the direction in which an arm presses most, in axes of the root; 0 for none, (3,)."""
    force = np.einsum('nij,nj->ni', arm.axes(q, outside.frame), outside.wrench[:, :3])
    size = np.linalg.norm(force, axis=1)
    most = -force[size >= np.percentile(size, _PRESSING)].mean(axis=0)
    length = float(np.linalg.norm(most))
    return np.asarray(most / length if length > _FELT_N else np.zeros(3))


_LEAST_SAMPLES = 200  # two seconds at the rate of slow drivers
STILL = 0.03  # range of a joint at rest [rad]: friction may hold anything over its presliding
GAP = 8.0  # sample periods without a message, at which a recording is cut
_SILENT = 0.5  # share of samples of no effort, from which on a joint is one that publishes none


@dataclass(frozen=True, eq=False)
class ArmRecording:
    """A recording of an arm with n joints."""

    name: str  # of the file
    joints: tuple[str, ...]  # as recorded
    t: Array  # (N,) stamps [s], increasing, from the first
    # q, v, tau (N, n): positions [rad], velocities [rad/s] and efforts [N m]; NaN where not
    # published
    q: Array
    v: Array
    tau: Array
    wrench: ArmWrench | None = None  # of the contact

    @property
    def has_effort(self) -> Flags:
        """Return which joints publish an effort that is neither constant nor mostly absent."""
        known = np.where(np.isfinite(self.tau), self.tau, 0.0)
        usual = np.median(known, axis=0)
        same = np.mean(np.abs(known - usual) <= 1e-9 + 1e-3 * known.std(axis=0), axis=0)
        return np.asarray((same < _SILENT) & np.isfinite(self.tau).any(axis=0))

    @property
    def moves(self) -> Flags:
        """Return which joints move, so that their torque tells more than a constant."""
        return np.asarray(np.max([np.ptp(self.q[rows], axis=0)
                                  for rows in self.stretches], axis=0) > STILL)

    @property
    def stretches(self) -> list[Any]:
        """Return the rows of each stretch without a gap."""
        steps = np.diff(self.t)
        return np.split(np.arange(len(self.t)), np.flatnonzero(steps > GAP * np.median(steps)) + 1)

    @property
    def has_velocity(self) -> Flags:
        """Return which joints publish a velocity."""
        return np.asarray(np.isfinite(self.v).all(axis=0) & (np.abs(self.v) > 0.0).any(axis=0))

    def of_joints(self, joints: tuple[str, ...]) -> 'ArmRecording':
        """Return the recording with its joints in another order, or fewer."""
        place = [self.joints.index(name) for name in joints]
        return replace(self, joints=joints, q=self.q[:, place], v=self.v[:, place],
                       tau=self.tau[:, place])


def read_arm_recording(
    path: str | PathLike[str], topics: Mapping[str, str] | None = None,
    parameters: Mapping[str, Any] | None = None, **reading: Any,
) -> ArmRecording:
    """
    Read the joint states of a whole arm, and its wrenches if there are any.

    path: recording, or table with columns of positions and efforts
    topics: recorded topics by 'joint_states' and 'wrench'; these names by default
    parameters: parameters of `estimator_node` by dotted name, of which those of sensor and tool
    are used
    **reading: further attributes of `RecordingSource`, such as columns={'joint.NAME': 'q0'}
    """
    source = RecordingSource.of_topics(topics or {}, **reading)
    reader = RecordingReader(str(path), source)
    readings = _readings(reader, source.joint_states)
    most = max(map(len, readings.values()))
    joints = tuple(name for name, rows in readings.items() if 2 * len(rows) > most)
    stamps, values = _aligned([np.array(readings[name], float) for name in joints])
    q, v, tau = np.moveaxis(values, -1, 0)
    finite = np.isfinite(q).all(axis=1)
    there = canonical(source.wrench) in map(canonical, reader.topics())
    return ArmRecording(
        Path(path).name, joints, 1e-9 * (stamps - stamps[0])[finite], q[finite], v[finite],
        tau[finite], _wrench(reader, source, parameters or {}, stamps[finite])
        if there or 'wrench' in (topics or {}) else None)


def _readings(
    reader: RecordingReader, topic: str
) -> dict[str, list[tuple[int, float, float, float]]]:
    """Return stamp [ns], position, velocity and effort of all joints; the last NaN if absent."""
    readings, refused = dict[str, list[tuple[int, float, float, float]]](), ''
    for batch in reader.batches([topic]):
        for message in batch:
            try:
                _add(readings, decode_arm(message.data))
            except MessageError as error:
                refused = f'; last refused: {error}'
    most = max(map(len, readings.values()), default=0)
    if most < _LEAST_SAMPLES:
        raise RecordingError(
            f'{reader.path} must hold at least {_LEAST_SAMPLES} joint states with positions on '
            f'topic {topic!r}, got {most}{refused}; record the arm in motion for some ten seconds')
    return readings


def _aligned(series: Sequence[Array]) -> tuple[Array, Array]:
    """Return the stamps (N,) [ns] of the longest series, and all of them there, (N, n, 3)."""
    longest = max(series, key=len)
    stamps, keep = np.unique(longest[:, 0], return_index=True)
    alike = all(len(one) == len(longest) and np.array_equal(one[:, 0], longest[:, 0])
                for one in series)
    return stamps, np.stack([one[keep, 1:] if alike else _interpolated(stamps, one)
                             for one in series], axis=1)


def _wrench(
    reader: RecordingReader, source: RecordingSource, chosen: Mapping[str, Any], stamps: Array
) -> ArmWrench | None:
    """Read the wrenches and interpolate them to stamps [ns]; None without a frame."""
    parameters = build(EstimationParameters, arm_parameters(reader, source, chosen))
    decoder = ForceTorqueDecoder()
    rows = [decoder.decode(one.data) for one in reader.messages([source.wrench])]
    frame = parameters.force_sensor.frame or decoder.frame_id
    if not rows or not frame:
        return None
    at, place = np.unique(np.array([stamp for stamp, _ in rows], float), return_index=True)
    values = np.array([wrench for _, wrench in rows], float)[place]
    return ArmWrench(frame, np.stack(
        [np.interp(stamps, at, column) for column in values.T], axis=1), parameters)


def _add(readings: dict[str, list[tuple[int, float, float, float]]], one: ArmReading) -> None:
    """Append the joints of a message; what a publisher leaves out is NaN."""
    count = len(one.names)
    if len(one.position) < count:
        return
    v, tau = (values if len(values) >= count else np.full(count, np.nan)
              for values in (one.velocity, one.effort))
    for k, name in enumerate(one.names):
        readings.setdefault(name, []).append((one.stamp_ns, one.position[k], v[k], tau[k]))


def _interpolated(stamps: Array, rows: Array) -> Array:
    rows = rows[np.unique(rows[:, 0], return_index=True)[1]]
    return np.stack([np.interp(stamps, rows[:, 0], rows[:, k]) for k in (1, 2, 3)], axis=1)


def named_as(recording: ArmRecording, arm: ArmDynamics) -> ArmRecording:
    """Return a recording of q0, q1, ..., as tables have them, with the names of an arm."""
    order = sorted(recording.joints, key=lambda name: (len(name), name))
    if len(order) != len(arm.joints) or not all(re.fullmatch(r'q\d+', name) for name in order):
        return recording
    return replace(recording.of_joints(tuple(order)), joints=arm.joints)


def joints_of(recording: ArmRecording, arm: ArmDynamics) -> tuple[str, ...]:
    """Return the joints of a description that a recording holds, from base to tip."""
    found = tuple(name for name in arm.joints if name in recording.joints)
    if not found:
        raise RecordingError(
            f'{recording.name} holds the joints {", ".join(recording.joints)}, expected those of '
            f'the robot description: {", ".join(arm.joints)}; give the description of this arm, '
            'with the prefix that its driver uses, or of a table --columns joint.NAME=COLUMN '
            'joint.NAME.effort=COLUMN ...')
    return found
