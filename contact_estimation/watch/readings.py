# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Position and force of the contact axis in raw messages, and a log of them for the view."""

from __future__ import annotations

from math import isfinite, nan
from typing import Mapping, NamedTuple, Protocol

from ..exceptions import MessageError, ParameterRangeError
from ..kinematics.contact_kinematics import ArmSample, ContactKinematics
from ..kinematics.robot_model import RobotModel
from ..pipeline.arm_kinematics import described_in_file, kinematics_of
from ..pipeline.parameters import EstimationParameters
from ..recordings.joint_decoding import JointStateDecoder, SomeJointsDecoder
from ..recordings.plain_decoding import ForceTorqueDecoder, WrenchDecoder
from ..recordings.readings import FORCE_OF_AXIS
from ..signals.joint_merging import JointMerger

INFO, WARNING = 'INFO', 'WARN'
STATUS, CHECKS = 'log/status', 'log/checks'
_AS_EXPECTED = ('free', 'estimating')


class LogText(NamedTuple):
    """A text with its level."""

    path: str  # `STATUS` or `CHECKS`
    stamp_ns: int  # when [ns]
    # text, level: what, and `INFO` or `WARNING`
    text: str
    level: str


class ContactLog:
    """
    Values and texts since the last time that they were taken.

    values: stamps [ns] and values by keys of plot and curve, as in 'force/measured'
    """

    def __init__(self) -> None:
        self.values: dict[str, tuple[list[int], list[float]]] = {}
        self.texts: list[LogText] = []
        self._status, self._checks = '', dict[str, str]()

    def add(self, path: str, stamp_ns: int, value: float) -> None:
        """Add a value of a curve in the unit of its plot; one that is not finite leaves a gap."""
        stamps, values = self.values.setdefault(path, ([], []))
        stamps.append(stamp_ns)
        values.append(value if isfinite(value) else nan)

    def add_estimate(self, key: str, stamp_ns: int, value: float, std: float) -> None:
        """Add an estimate and its band of 2 standard deviations; NaN while unknown."""
        self.add(f'{key}/estimate', stamp_ns, value)
        # A band wider than the value says that nothing is known yet, and would flatten the plot.
        band = 2.0 * std if 2.0 * std < abs(value) else nan
        self.add(f'{key}/upper', stamp_ns, value + band)
        self.add(f'{key}/lower', stamp_ns, value - band)

    def add_status(self, stamp_ns: int, text: str) -> None:
        """Add the state of the estimator where it has changed; stamp_ns: when [ns]."""
        if text != self._status:
            self._status = text
            level = INFO if text.startswith(_AS_EXPECTED) else WARNING
            self.texts.append(LogText(STATUS, stamp_ns, text, level))

    def add_checks(self, stamp_ns: int, active: Mapping[str, str]) -> None:
        """
        Add which warnings have begun or ended.

        stamp_ns: when [ns]
        active: texts of the active warnings, by what stays the same while their numbers change
        """
        for key, text in active.items():
            if key not in self._checks:
                self.texts.append(LogText(CHECKS, stamp_ns, text, WARNING))
        for key, text in self._checks.items():
            if key not in active:
                self.texts.append(LogText(CHECKS, stamp_ns, f'over: {text}', INFO))
        self._checks = dict(active)

    def take(self) -> tuple[dict[str, tuple[list[int], list[float]]], list[LogText]]:
        """Return `values` and `texts`, and begin anew."""
        taken = self.values, self.texts
        self.values, self.texts = {}, []
        return taken


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
