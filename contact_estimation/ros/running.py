# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Start, run and shut down a node of this package, and its log."""

import gc
import os
import signal
import sys
from threading import Event
import time
from typing import Any, Callable, Iterable, Mapping, Protocol, Sequence

import rclpy
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import LoggingSeverity, set_logger_level
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from .topics import JOINT_STATES, REFERENCE, TF, WRENCH
from ..exceptions import ContactEstimationError
from ..kinematics.parameters import JOINT_EFFORTS
from ..parameters import ParameterSpecification, value_text
from ..pipeline.parameters import EstimationParameters
from ..texts import print_help

_AGAIN_S = 10.0  # a warning that stays is repeated after this time
_QUIET_S = 1.0  # between two changes of state


class NodeLog:
    """Start, changes and warnings of an estimator node, throttled."""

    def __init__(self, node: Any) -> None:
        self._node, self._logger = node, node.get_logger()
        self._warned: dict[str, float] = {}
        self._state = ''
        self._state_time = -_QUIET_S

    def started(self, parameters: EstimationParameters) -> None:
        """Write topics, joints, axes and estimator."""
        resolve = self._node.resolve_topic_name
        axes = ', '.join(f'{axis} from joint {joint!r}' if joint else f'{axis} from the only joint'
                         for axis, joint in parameters.joints.items())
        axes += ' in metres'
        if parameters.kinematics.tip:
            axes = f'{parameters.axis} along contact.normal of an arm'
        motion = TF if parameters.pose_source == 'tf' else JOINT_STATES
        of_joints = parameters.wrench_source == JOINT_EFFORTS
        force = f'efforts of {resolve(motion)}' if of_joints else resolve(WRENCH)
        x_e = parameters.environment.location
        place = f'x_e = {x_e:g} m' if x_e == x_e else 'x_e taken at the first touch'
        self._logger.info(
            f'estimator {parameters.estimator}, {parameters.reference_law}; force from '
            f'{force}, motion from {resolve(motion)}, axis {axes}; {place}; '
            f'estimates on {resolve("~/stiffness")}, reference on {resolve(REFERENCE)}')

    def changed(self, changes: Mapping[str, Any]) -> None:
        """Write changed parameters."""
        self._logger.info(
            'changed ' + ', '.join(f'{name} = {value!r}' for name, value in changes.items()))

    def event(self, text: str) -> None:
        """Write what a service has done."""
        self._logger.info(text)

    def state(self, text: str, stiffness: float) -> None:
        """Write the state of the estimation where it has changed."""
        now = time.monotonic()
        if text != self._state and now - self._state_time >= _QUIET_S:
            self._state, self._state_time = text, now
            self._logger.info(f'{text} (K_hat = {stiffness:.6g} N/m)')

    def warning(self, name: str, text: str) -> None:
        """Write a warning: at once where it is new, then every ten seconds."""
        now = time.monotonic()
        if now - self._warned.get(name, -_AGAIN_S) >= _AGAIN_S:
            self._warned[name] = now
            self._logger.warning(text)


_DELIVERY_S = 4.0  # DDS offers again what was lost on the way every 3 s


class RunnableNode(Protocol):
    """A node with data threads."""

    def start(self) -> None:
        """Start the threads."""

    def stop(self) -> None:
        """Stop all threads and close files."""

    @property
    def finished(self) -> bool:
        """Whether the task of the node is complete."""


def run_node(
    make: Callable[[], RunnableNode], purpose: str, known: Iterable[ParameterSpecification],
    args: Sequence[str] | None, topic: str = '',
) -> int:
    """Run a node until it has finished or is interrupted."""
    arguments = list(sys.argv[1:] if args is None else args)
    if '--help' in arguments or '-h' in arguments:
        print_help(help_text(purpose, known, topic))
        return 0
    # rclpy.init needs a directory for its logs.
    if 'HOME' not in os.environ:
        os.environ.setdefault('ROS_LOG_DIR', '/tmp')
    interrupted = _on_signals()
    try:
        # rcl would print the error of a parameter file first, over several lines.
        set_logger_level('rcl', LoggingSeverity.FATAL)
        rclpy.init(args=['node', *arguments], signal_handler_options=SignalHandlerOptions.NO)
        set_logger_level('rcl', LoggingSeverity.UNSET)
    except Exception as error:  # noqa: B902 - the errors of rcl have no common base class
        print(f'cannot start: {_one_line(error)}', file=sys.stderr)
        return 1
    try:
        return _spin(make(), interrupted)
    except ContactEstimationError as error:
        print(f'error: {error}', file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()


def _on_signals() -> Event:
    """Return an event that SIGINT and SIGTERM set, instead of ending at once."""
    # rclpy's own handlers shut the context down at once, under a thread that is about to publish;
    # here the threads end first, and samples that have arrived are still processed.
    interrupted = Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: interrupted.set())
    return interrupted


def _spin(node: RunnableNode, interrupted: Event) -> int:
    executor = SingleThreadedExecutor()
    assert isinstance(node, Node)
    executor.add_node(node)
    # All that is loaded by now stays: a collection that walks through it takes 30 ms.
    gc.collect()
    gc.freeze()
    node.start()
    try:
        while not interrupted.is_set() and not node.finished:
            executor.spin_once(timeout_sec=0.2)
    finally:
        node.stop()
        _deliver(node)
        executor.shutdown()
        node.destroy_node()
    return 0


def _deliver(node: Node) -> None:
    """Wait until every reliable subscriber has what was published: else its end would be lost."""
    give_up = time.monotonic() + _DELIVERY_S
    for publisher in node.publishers:
        publisher.wait_for_all_acked(Duration(seconds=max(0.0, give_up - time.monotonic())))


def help_text(purpose: str, known: Iterable[ParameterSpecification], topic: str = '') -> str:
    """Write the help of a node."""
    remapping = f' -r {topic}:=/my/{topic}' if topic else ''
    lines = [
        purpose,
        '',
        f'usage: {purpose.partition(":")[0]} [--ros-args -p NAME:=VALUE --params-file FILE'
        f'{remapping} ...]',
        '',
        'parameters:']
    for spec in known:
        lines.append(f'  {spec.name} = {value_text(spec.default)}: {spec.expectation}')
        lines.append(f'      {spec.description}')
    return '\n'.join(lines)


def _one_line(error: Exception) -> str:
    return ' '.join(str(error).split())
