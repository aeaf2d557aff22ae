# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""From raw messages of a running estimator to a log for the view; independent of ROS."""

from contextlib import suppress
from functools import partial
from math import isfinite, nan
import re
from typing import Any, Callable, Mapping, NamedTuple

from ..exceptions import MessageError, ParameterRangeError
from ..kinematics.contact_kinematics import ArmSample, ContactKinematics
from ..kinematics.robot_model import RobotModel
from ..parameters import build, changed
from ..pipeline.arm_kinematics import described_in_file, kinematics_of
from ..pipeline.events import DESCRIPTION, EstimationEvent, START
from ..pipeline.parameters import EstimationParameters
from ..recordings.decoding import (
    decode_diagnostics, decode_string, DIAGNOSTICS_TYPE, FORCE_OF_AXIS, ForceTorqueDecoder,
    JointsDecoder, JointStateDecoder, TrajectoryDecoder, Vector3StampedDecoder, WrenchDecoder)
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
    """Values, by plot and curve as in 'force/measured', and texts, since they were last taken."""

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
        """Add which warnings have begun or ended, by what stays the same in their texts."""
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


class AxisReadings:
    """A single prismatic axis; messages that cannot be used raise a `MessageError`."""

    def __init__(self, parameters: EstimationParameters) -> None:
        self._wrench, self._joints = WrenchDecoder(), JointStateDecoder(parameters.joint)
        self._component, self._sign = FORCE_OF_AXIS[parameters.axis], parameters.force_sign

    def force(self, raw: bytes) -> Reading:
        wrench = self._wrench.decode(raw)
        return Reading(wrench.stamp_ns, self._sign * self._component(wrench))

    def position(self, raw: bytes) -> Reading:
        joint = self._joints.decode(raw)
        return Reading(joint.stamp_ns, joint.position)


class ArmReadings:
    """The normal of an arm, as the estimator finds it; None until all joints are known."""

    def __init__(self, kinematics: ContactKinematics) -> None:
        self._kinematics, model = kinematics, kinematics.model
        self._wrench = ForceTorqueDecoder()
        self._joints = JointsDecoder(model.joint_names, every=False)
        assert isinstance(model, RobotModel), 'poses from tf are refused by readings_of'
        self._merger = JointMerger(model.continuous)
        self._motion: tuple[float, ...] = ()

    def force(self, raw: bytes) -> Reading | None:
        stamp_ns, wrench = self._wrench.decode(raw)
        if not self._motion:
            return None
        if not self._kinematics.sensor:
            self._kinematics.use_sensor(self._wrench.frame_id)
        sample = ArmSample(stamp_ns, self._motion, wrench)
        return Reading(stamp_ns, self._kinematics.contact(sample).force)

    def position(self, raw: bytes) -> Reading | None:
        row = self._merger.add(*self._joints.decode(raw))
        if row is None:
            return None
        self._motion = tuple(row[1])
        return Reading(row[0], self._kinematics.motion(self._motion)[2])


Readings = AxisReadings | ArmReadings


def readings_of(parameters: EstimationParameters, description: str = '') -> Readings | None:
    """Return what reads the messages of a configured estimator."""
    if not parameters.kinematics.tip:
        return AxisReadings(parameters)
    if parameters.pose_source == 'tf':
        raise ParameterRangeError(
            'the live view reads the motion of an arm from its joint states, but pose_source is '
            'tf; watch a recording of it (watch RECORDING), or set pose_source to joints')
    text = description or described_in_file(parameters)
    return ArmReadings(kinematics_of(parameters, text)) if text else None


WRENCH, JOINTS = 'geometry_msgs/msg/WrenchStamped', 'sensor_msgs/msg/JointState'
TRAJECTORY, VECTOR = 'trajectory_msgs/msg/JointTrajectory', 'geometry_msgs/msg/Vector3Stamped'
TEXT = 'std_msgs/msg/String'


class Subscription(NamedTuple):
    """A topic that the view needs."""

    # topic, type_name: name, relative to the namespace, and type
    topic: str
    type_name: str
    callback: Callable[[bytes], None]  # takes the raw message
    latched: bool = False  # whether the last message is kept for late subscribers


class LiveContact:
    """What a running estimator and its inputs publish, less what cannot be used."""

    def __init__(self, log: ContactLog, estimator: str = 'estimator_node') -> None:
        self._log, self._estimator = log, estimator
        self._vectors = Vector3StampedDecoder()
        self._trajectories = TrajectoryDecoder()
        self._axis, self._stamp_ns, self._waiting = 'x', 0, ''
        self._stds: dict[str, float] = {}
        self._parameters = build(EstimationParameters, {})
        self._description = ''
        self._readings: Readings | None = readings_of(self._parameters)

    def subscriptions(self) -> list[Subscription]:
        """Return what the view needs."""
        own = self._estimator
        return [
            Subscription('wrench', WRENCH, self._on_wrench),
            Subscription('joint_states', JOINTS, self._on_joints),
            Subscription('desired_trajectory', TRAJECTORY,
                         partial(self._on_setpoint, 'motion/desired', '')),
            Subscription('reference_trajectory', TRAJECTORY,
                         partial(self._on_setpoint, 'motion/reference', 'force/desired')),
            Subscription(f'{own}/stiffness', VECTOR, partial(self._on_estimate, 'stiffness')),
            Subscription(f'{own}/damping', VECTOR, partial(self._on_estimate, 'damping')),
            Subscription('/diagnostics', DIAGNOSTICS_TYPE, self._on_diagnostics),
            Subscription(f'{own}/status', TEXT, self._on_status, latched=True),
            Subscription(f'{own}/events', TEXT, self._on_event, latched=True)]

    # -- topics -----------------------------------------------------------------------------

    def _on_wrench(self, raw: bytes) -> None:
        with suppress(MessageError):
            reading = self._readings.force(raw) if self._readings else None
            if reading is not None:
                self._stamp_ns = max(self._stamp_ns, reading.stamp_ns)
                self._log.add('force/measured', reading.stamp_ns, -reading.value)
                if self._waiting:
                    self._log.add_status(self._stamp_ns, self._waiting)
                    self._waiting = ''

    def _on_joints(self, raw: bytes) -> None:
        with suppress(MessageError):
            reading = self._readings.position(raw) if self._readings else None
            if reading is not None:
                self._log.add('motion/measured', reading.stamp_ns, 1e3 * reading.value)

    def _on_setpoint(self, path: str, force_path: str, raw: bytes) -> None:
        with suppress(MessageError):
            stamp_ns, x, _, _, force = self._trajectories.decode(raw)
            self._log.add(path, stamp_ns, 1e3 * x)
            if force_path:
                self._log.add(force_path, stamp_ns, force)

    def _on_estimate(self, key: str, raw: bytes) -> None:
        stamp_ns, value = self._component(raw)
        self._log.add_estimate(key, stamp_ns, value, self._stds.get(key, nan))

    def _component(self, raw: bytes) -> tuple[int, float]:
        stamp_ns, *vector = self._vectors.decode(raw)
        return stamp_ns, vector['xyz'.index(self._axis)]

    def _on_diagnostics(self, raw: bytes) -> None:
        for _, name, _, values in decode_diagnostics(raw):
            if name.partition(':')[0].rpartition('/')[2] == self._estimator.rpartition('/')[2]:
                self._report(values)

    def _report(self, values: Mapping[str, str]) -> None:
        if not self._stamp_ns:
            return
        active = [text for key, text in values.items() if key.startswith('warning_')]
        self._log.add_checks(self._stamp_ns, {_without_numbers(text): text for text in active})
        self._stds = {
            key: float(values.get(f'{key}_std', nan)) for key in ('stiffness', 'damping')}
        self._log.add('model_fit/ratio', self._stamp_ns, float(values.get('model_fit', nan)))

    def _on_status(self, raw: bytes) -> None:
        text = decode_string(raw)
        if self._stamp_ns:
            self._log.add_status(self._stamp_ns, text)
        else:
            self._waiting = text  # without a stamp of its own, for that of the first wrench

    def _on_event(self, raw: bytes) -> None:
        event = EstimationEvent.from_text(decode_string(raw))
        values: dict[str, Any] = dict(event.parameters)
        if event.kind == START:
            self._parameters = build(EstimationParameters, values)
        elif event.kind == DESCRIPTION:
            self._description = values['text']
        elif event.kind == 'set_parameters':
            self._parameters = changed(self._parameters, values)
        else:
            return
        self._axis = self._parameters.axis
        self._readings = readings_of(self._parameters, self._description)


def _without_numbers(text: str) -> str:
    return re.sub(r'[-+.\w]*\d[-+.\w]*', '#', text)
