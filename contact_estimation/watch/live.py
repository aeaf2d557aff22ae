# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""From raw messages of a running estimator to the view; independent of ROS."""

from __future__ import annotations

from math import nan
import re
from typing import Any, Callable, Mapping, NamedTuple

from .readings import ContactLog, Reading, Readings, readings_of
from ..exceptions import MessageError
from ..parameters import build, changed
from ..pipeline.events import DESCRIPTION, EstimationEvent, START
from ..pipeline.parameters import EstimationParameters
from ..recordings.joint_decoding import TrajectoryDecoder
from ..recordings.plain_decoding import (
    decode_diagnostics, decode_float64, decode_string, DIAGNOSTICS_TYPE, Vector3StampedDecoder)

WRENCH, JOINTS = 'geometry_msgs/msg/WrenchStamped', 'sensor_msgs/msg/JointState'
TRAJECTORY, VECTOR = 'trajectory_msgs/msg/JointTrajectory', 'geometry_msgs/msg/Vector3Stamped'
FLOAT, TEXT = 'std_msgs/msg/Float64', 'std_msgs/msg/String'


class Subscription(NamedTuple):
    """A topic that the view needs."""

    # topic, type_name: name, relative to the namespace, and type
    topic: str
    type_name: str
    callback: Callable[[bytes], None]  # takes the raw message
    latched: bool = False  # whether the last message is kept for late subscribers


class LiveContact:
    """
    What a running estimator and its inputs publish.

    Messages that cannot be used are left out: the estimator reports them.
    """

    def __init__(
        self, log: ContactLog, estimator: str = 'estimator_node', sparing: bool = False
    ) -> None:
        self._log, self._estimator, self._sparing = log, estimator, sparing
        self._vectors = Vector3StampedDecoder()
        self._trajectories = TrajectoryDecoder()
        self._axis, self._stamp_ns, self._waiting = 'x', 0, ''
        self._stds: dict[str, float] = {}
        self._last = {'stiffness': Reading(0, nan), 'damping': Reading(0, nan)}
        self._parameters = build(EstimationParameters, {})
        self._description = ''
        self._readings: Readings | None = readings_of(self._parameters)

    def subscriptions(self) -> list[Subscription]:
        """Return what the view needs."""
        own = self._estimator
        needed = [
            Subscription('wrench', WRENCH, self._on_wrench),
            Subscription('joint_states', JOINTS, self._on_joints),
            Subscription('desired_trajectory', TRAJECTORY, self._on_desired),
            Subscription('reference_trajectory', TRAJECTORY, self._on_reference),
            Subscription(f'{own}/stiffness', VECTOR, self._on_estimate('stiffness')),
            Subscription(f'{own}/damping', VECTOR, self._on_estimate('damping')),
            Subscription('/diagnostics', DIAGNOSTICS_TYPE, self._on_diagnostics),
            Subscription(f'{own}/status', TEXT, self._on_status, latched=True),
            Subscription(f'{own}/events', TEXT, self._on_event, latched=True),
        ]
        if self._sparing:
            return needed
        return [
            *needed,
            Subscription(f'{own}/stiffness_std', VECTOR, self._on_std('stiffness')),
            Subscription(f'{own}/damping_std', VECTOR, self._on_std('damping')),
            Subscription(f'{own}/model_fit', FLOAT, self._on_fit),
        ]

    # -- topics -----------------------------------------------------------------------------

    def _on_wrench(self, raw: bytes) -> None:
        reading = self._readings.force(raw) if self._readings else None
        if reading is not None:
            self._stamp_ns = max(self._stamp_ns, reading.stamp_ns)
            self._log.add('force/measured', reading.stamp_ns, -reading.value)
            if self._waiting:
                self._log.add_status(self._stamp_ns, self._waiting)
                self._waiting = ''

    def _on_joints(self, raw: bytes) -> None:
        reading = self._readings.position(raw) if self._readings else None
        if reading is not None:
            self._log.add('motion/measured', reading.stamp_ns, 1e3 * reading.value)

    def _on_desired(self, raw: bytes) -> None:
        self._add_setpoint('motion/desired', raw)

    def _on_reference(self, raw: bytes) -> None:
        self._add_setpoint('motion/reference', raw, 'force/desired')

    def _add_setpoint(self, path: str, raw: bytes, force_path: str = '') -> None:
        try:
            stamp_ns, x, _, _, force = self._trajectories.decode(raw)
        except MessageError:
            return
        self._log.add(path, stamp_ns, 1e3 * x)
        if force_path:
            self._log.add(force_path, stamp_ns, force)

    def _on_estimate(self, key: str) -> Callable[[bytes], None]:
        def on_estimate(raw: bytes) -> None:
            stamp_ns, value = self._component(raw)
            if self._sparing:
                self._log.add_estimate(key, stamp_ns, value, self._stds.get(key, nan))
                return
            self._add_last(key)  # its deviation was dropped
            self._last[key] = Reading(stamp_ns, value)

        return on_estimate

    def _on_std(self, key: str) -> Callable[[bytes], None]:
        def on_std(raw: bytes) -> None:
            stamp_ns, std = self._component(raw)
            if stamp_ns == self._last[key].stamp_ns:
                self._add_last(key, std)

        return on_std

    def _add_last(self, key: str, std: float = nan) -> None:
        """Add the last estimate, once."""
        last, self._last[key] = self._last[key], Reading(0, nan)
        if last.stamp_ns:
            self._log.add_estimate(key, *last, std)

    def _component(self, raw: bytes) -> tuple[int, float]:
        stamp_ns, *vector = self._vectors.decode(raw)
        return stamp_ns, vector['xyz'.index(self._axis)]

    def _on_fit(self, raw: bytes) -> None:
        if self._stamp_ns:  # the message has no stamp
            self._log.add('model_fit/ratio', self._stamp_ns, decode_float64(raw))

    def _on_diagnostics(self, raw: bytes) -> None:
        for _, name, _, values in decode_diagnostics(raw):
            if name.partition(':')[0].rpartition('/')[2] == self._estimator.rpartition('/')[2]:
                self._report(values)

    def _report(self, values: Mapping[str, str]) -> None:
        if not self._stamp_ns:
            return
        active = [text for key, text in values.items() if key.startswith('warning_')]
        self._log.add_checks(self._stamp_ns, {_without_numbers(text): text for text in active})
        self._stds = {key: float(values.get(f'{key}_std', nan)) for key in self._last}
        if self._sparing:
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
