# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Diagnostics of the estimator node, and the graph of ROS as it sees it."""

from collections import deque
from math import inf, isfinite
import time
from typing import Any, Callable, Mapping, Sequence

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from . import topics
from .plant_statistics import percentiles
from ..estimators.estimate import Estimate
from ..kinematics.parameters import JOINT_EFFORTS
from ..pipeline.arm_kinematics import NO_DESCRIPTION
from ..pipeline.checks import lag_in_words, Rejections
from ..pipeline.checks.stream_checks import graph_warnings
from ..pipeline.parameters import EstimationParameters
from ..pipeline.session import ContactSession
from ..pipeline.wall_law import laws_in_words, ModelFitMonitor

_EVERY_S = 1.0
_OTHER_JOINTS = 'joint_states_joint_unknown'


class Graph:
    """Warn of several publishers of one measurement, and of several nodes of one name."""

    def __init__(self, node: Node) -> None:
        self._node, self._looked = node, -inf
        self._found: dict[str, str] = {}

    def warnings(self, session: ContactSession) -> dict[str, str]:
        """Return texts by name."""
        if time.monotonic() - self._looked >= _EVERY_S:
            self._looked = time.monotonic()
            self._found = self._look(session)
        return self._found

    def _look(self, session: ContactSession) -> dict[str, str]:
        measured = [topics.WRENCH]
        # Of an arm, and where other joints are on the topic, each publisher may have its own.
        if not session.parameters.kinematics.tip and not session.rejected[_OTHER_JOINTS]:
            measured.append(topics.JOINT_STATES)
        publishers = {}
        for topic in map(self._node.resolve_topic_name, measured):
            publishers[topic] = [_full(one.node_namespace, one.node_name)
                                 for one in self._node.get_publishers_info_by_topic(topic)]
        nodes = [_full(namespace, name)
                 for name, namespace in self._node.get_node_names_and_namespaces()]
        return graph_warnings(publishers, self._node.get_fully_qualified_name(), nodes)


def _full(namespace: str, name: str) -> str:
    return f'{namespace.rstrip("/")}/{name}'


_LATENCIES_KEPT = 2000
_STARTING_S = 5.0  # in which the log does not complain of a sensor that starts after the node


class EstimatorDiagnostics:
    """
    Collect statistics at every sample and report them as a diagnostic status.

    silence_s: time without a wrench after which the status is ERROR [s]
    now_ns: the node's clock, by which latencies are measured [ns]
    description_topic: on which the description of an arm is awaited
    graph: from the session to what the graph of ROS warns of, texts by name
    headline: name and text of the main warning of the last report; '' without one
    """

    def __init__(
        self, name: str, silence_s: float, hardware_id: str = '',
        now_ns: Callable[[], int] = time.time_ns, description_topic: str = '/robot_description',
        graph: Callable[[ContactSession], Mapping[str, str]] = lambda session: {},
    ) -> None:
        self._name, self.silence_s = name, silence_s
        self.hardware_id, self._now_ns = hardware_id, now_ns
        self._description_topic, self._graph = description_topic, graph
        self.headline = '', ''
        self._rejections: Rejections | None = None
        self.processed = 0
        self.errors = 0
        self.last_error = ''
        self._latencies_ns: deque[int] = deque(maxlen=_LATENCIES_KEPT)
        self._arrived = False
        self._last_arrival = time.monotonic()
        self._before = (0, self._last_arrival)

    def arrived(self) -> None:
        """Note the arrival of a wrench."""
        self._arrived = True
        self._last_arrival = time.monotonic()

    def published(self, stamp_ns: int) -> None:
        """Note that the outputs for a sample have been published; stamp_ns: of the sample [ns]."""
        self.processed += 1
        self._latencies_ns.append(self._now_ns() - stamp_ns)

    def failed(self, error: Exception) -> None:
        """Note an exception in a data callback."""
        self.errors += 1
        self.last_error = f'{type(error).__name__}: {error}'

    def message(
        self, stamp: Any, session: ContactSession, estimates: Sequence[Estimate]
    ) -> DiagnosticArray:
        """Return the diagnostic message."""
        estimate = estimates[0] if estimates else None
        starved = self.processed == self._before[0]
        warnings = self._warnings(session, starved)
        level, text = self._judge(
            warnings, estimate, self._problem_of(session), session.parameters)
        values = {**self._rates(), **self._estimation(session, estimate)}
        for (axis, pipeline), other in list(zip(session.pipelines.items(), estimates))[1:]:
            values.update((f'{axis}_{k}', v) for k, v in _values_of(other).items())
            values[f'{axis}_contact'] = pipeline.contact
            values.update((f'{axis}_{k}', v) for k, v in _fit_of(pipeline.model_fit).items())
        if session.matrix.runs:
            values['matrix_status'] = session.matrix.status
        values.update(self._problems(session))
        values.update((f'warning_{k}', text) for k, (_, text) in enumerate(warnings, start=1))
        status = DiagnosticStatus(
            level=level, name=f'{self._name}: contact estimation', message=text,
            hardware_id=self.hardware_id,
            values=[KeyValue(key=k, value=str(v)) for k, v in values.items()])
        message = DiagnosticArray(status=[status])
        message.header.stamp = stamp
        return message

    def _judge(
        self, warnings: list[tuple[str, str]], estimate: Estimate | None, problem: str,
        parameters: EstimationParameters,
    ) -> tuple[bytes, str]:
        silent = time.monotonic() - self._last_arrival
        self.headline = '', ''
        if problem or silent > self.silence_s:
            # Without its description or frames an arm has no use for wrenches.
            lacking = 'transforms' if parameters.motion_topic == 'tf' else 'robot_description'
            of_joints = parameters.wrench_source == JOINT_EFFORTS
            what, who = ('efforts of joints', 'arm') if of_joints else ('wrench', 'sensor')
            name, text = (lacking, problem) if problem else (
                'silence', f'no {what} for {silent:.1f} s; is the {who} running?')
            if self._arrived or silent > _STARTING_S:
                self.headline = name, text
            return DiagnosticStatus.ERROR, text
        if warnings:
            self.headline = warnings[0]
            return DiagnosticStatus.WARN, warnings[0][1]
        if estimate is None:
            self.headline = 'joint_missing', (
                'wrenches come, but no motion at their stamps; is '
                f'{parameters.motion_topic} published, or remapped?')
            return DiagnosticStatus.WARN, self.headline[1]
        reason = f': {estimate.reason}' if estimate.reason else ''
        return DiagnosticStatus.OK, f'{estimate.status.value}{reason}'

    def _problem_of(self, session: ContactSession) -> str:
        """Return why there is no arm, with the topic subscribed; '' if nothing is wrong."""
        if session.problem == NO_DESCRIPTION:
            return (f'waiting for the robot description on {self._description_topic}; is '
                    'robot_state_publisher running? Or set robot_description_file')
        return session.problem

    def _warnings(self, session: ContactSession, starved: bool) -> list[tuple[str, str]]:
        """Return names and texts, the most important first."""
        if self._rejections is None:
            self._rejections = Rejections(
                lambda reason: session.rejection_texts.get(reason, ''),
                lambda: lag_in_words(session.motion_lag_s, session.parameters.motion_topic))
        rejected = self._rejections.new_warnings(session.rejected, self.processed)
        active = [*self._graph(session).items(), *session.notices.items()]
        active += [(warned.name, warned.text) for warned in session.checks.warnings()]
        if not rejected[0]:
            return active
        return [rejected, *active] if starved else [*active, rejected]

    def _rates(self) -> dict[str, Any]:
        now = time.monotonic()
        (count, then), self._before = self._before, (self.processed, now)
        rate = (self.processed - count) / max(now - then, 1e-6)
        values: dict[str, Any] = {'samples': self.processed, 'rate_hz': f'{rate:.1f}'}
        for name, latency in percentiles(list(self._latencies_ns)).items():
            if latency is not None:
                values[f'latency_ms_{name}'] = f'{latency * 1e-6:.3f}'
        return values

    @staticmethod
    def _estimation(session: ContactSession, estimate: Estimate | None) -> dict[str, Any]:
        pipeline, parameters = session.pipeline, session.parameters
        values: dict[str, Any] = {
            'estimator': parameters.estimator,
            'reference_law': parameters.reference_law,
            'reference_limited': session.stream.limited,
            'contact': pipeline.contact,
            'position': f'{session.last_position:.6g}',
            'contact_probability': f'{pipeline.posterior.contact.probability:.3f}',
            'wall_law': laws_in_words(pipeline.posterior.known.laws),
            'wall_changes': pipeline.posterior.wall.changes,
            **{f'excitation_{name}_std': f'{std:.3g}' for name, std in zip(
                ('stiffness', 'damping'), pipeline.posterior.wall.excitation)},
            'force_lag_ms': '{:.2f} +- {:.2f}'.format(
                *(1e3 * s for s in pipeline.posterior.wall.lag.lag)),
            'force_noise_std': f'{pipeline.posterior.contact.noise_std:.6g}',
            'force_bias': f'{pipeline.bias:.6g}',
            'free_flight_level': f'{pipeline.posterior.contact.level:.6g}',
        }
        if estimate is None:
            return values
        estimator = pipeline.estimator
        details = {f'{parameters.estimator}_{name}': f'{value:.8g}'
                   for name, value in (estimator.details if estimator else {}).items()}
        return {**values, **_values_of(estimate), **_fit_of(pipeline.model_fit), **details}

    def _problems(self, session: ContactSession) -> dict[str, Any]:
        values: dict[str, Any] = {
            'missing': session.pipeline.missing,
            'outliers': session.pipeline.posterior.blocks.outliers,
            'time_jumps': session.time_jumps,
            'errors': self.errors,
        }
        values.update((f'rejected_{k}', v) for k, v in sorted(session.rejected.items()))
        if self.last_error:
            values['last_error'] = self.last_error
        return values


def _values_of(estimate: Estimate) -> dict[str, str]:
    """Return the estimate of one axis as texts."""
    values = {}
    for name in ('stiffness', 'stiffness_std', 'damping', 'damping_std', 'location', 'inertia'):
        value = getattr(estimate, name)
        if isfinite(value):
            values[name] = f'{value:.8g}'
    values['status'] = estimate.status.value
    values['reason'] = estimate.reason
    return values


def _fit_of(monitor: ModelFitMonitor) -> dict[str, Any]:
    """Return how the model fits now, and the worst mismatch so far."""
    values: dict[str, Any] = {
        'model_fit': f'{monitor.now.ratio:.3g}', 'model_mismatches': monitor.count
    }
    if monitor.worst.text:
        values['model_fit_worst'] = f'{monitor.worst.ratio:.3g}'
        values['model_fit_worst_text'] = monitor.worst.text
    return values
