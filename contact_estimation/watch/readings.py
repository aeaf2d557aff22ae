# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Position and force of the contact axis in raw messages, of a single joint or of an arm."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from ..exceptions import MessageError, ParameterRangeError
from ..kinematics.contact_kinematics import ArmSample, ContactKinematics
from ..kinematics.robot_model import RobotModel
from ..messages import (
    FORCE_OF_AXIS, ForceTorqueDecoder, JointStateDecoder, SomeJointsDecoder, WrenchDecoder)
from ..pipeline.arm_kinematics import described_in_file, kinematics_of
from ..pipeline.parameters import EstimationParameters
from ..signals.joint_merging import JointMerger


class Reading(NamedTuple):
    """One value."""

    stamp_ns: int  # header stamp [ns]
    value: float  # force F_e [N] or position [m]


class Readings(Protocol):
    """The contact axis in raw messages."""

    def force(self, raw: bytes) -> Reading | None:
        """Return F_e of a wrench; None where it cannot be used."""

    def position(self, raw: bytes) -> Reading | None:
        """Return x of a joint state; None where it cannot be used."""


class AxisReadings:
    """A single prismatic axis."""

    def __init__(self, parameters: EstimationParameters) -> None:
        self._wrench, self._joints = WrenchDecoder(), JointStateDecoder(parameters.joint)
        self._component, self._sign = FORCE_OF_AXIS[parameters.axis], parameters.force_sign

    def force(self, raw: bytes) -> Reading | None:
        """Return F_e of a wrench; None where it cannot be used."""
        try:
            wrench = self._wrench.decode(raw)
        except MessageError:
            return None
        return Reading(wrench.stamp_ns, self._sign * self._component(wrench))

    def position(self, raw: bytes) -> Reading | None:
        """Return x of a joint state; None where it cannot be used."""
        try:
            joint = self._joints.decode(raw)
        except MessageError:
            return None
        return Reading(joint.stamp_ns, joint.position)


class ArmReadings:
    """The normal of an arm, by the kinematics that the estimator uses."""

    def __init__(self, kinematics: ContactKinematics) -> None:
        self._kinematics, model = kinematics, kinematics.model
        self._wrench, self._joints = ForceTorqueDecoder(), SomeJointsDecoder(model.joint_names)
        assert isinstance(model, RobotModel), 'poses from tf are refused by readings_of'
        self._merger = JointMerger(model.continuous)
        self._motion: tuple[float, ...] = ()

    def force(self, raw: bytes) -> Reading | None:
        """Return F_e of a wrench at the last joints; None where it cannot be used."""
        try:
            stamp_ns, wrench = self._wrench.decode(raw)
        except MessageError:
            return None
        if not self._motion:
            return None
        if not self._kinematics.sensor:
            self._kinematics.use_sensor(self._wrench.frame_id)
        sample = ArmSample(stamp_ns, self._motion, wrench)
        return Reading(stamp_ns, self._kinematics.contact(sample).force)

    def position(self, raw: bytes) -> Reading | None:
        """Return x of a joint state; None until all joints are known."""
        try:
            row = self._merger.add(*self._joints.decode(raw))
        except MessageError:
            return None
        if row is None:
            return None
        self._motion = tuple(row[1])
        return Reading(row[0], self._kinematics.motion(self._motion)[2])


def readings_of(parameters: EstimationParameters, description: str = '') -> Readings | None:
    """Return what reads the messages of a configured estimator."""
    if not parameters.kinematics.tip:
        return AxisReadings(parameters)
    if parameters.pose_source == 'tf':
        raise ParameterRangeError(
            'the live view reads the motion of an arm from its joint states, but pose_source is '
            'tf; watch a recording of it (watch RECORDING), or set pose_source to joints'
        )
    text = description or described_in_file(parameters)
    return ArmReadings(kinematics_of(parameters, text)) if text else None
