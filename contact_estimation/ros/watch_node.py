# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Watch a running estimator, from a process of which the estimator is unaware."""

from dataclasses import dataclass
import os
from threading import Lock
from typing import Any, Callable, Sequence

from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy

from . import topics
from .data_thread import DataThread, RawSubscriptions
from .parameters import declare
from .running import run_node
from ..parameters import build, parameter, ParameterGroup, specifications
from ..watch.live import LiveContact
from ..watch.view import ContactView, show

PURPOSE = 'watch_node: show a running estimator in Rerun'
_FLUSH_S = 0.1
_NICENESS = 10

# Best effort: the estimator waits for no acknowledgement of a spectator.
_QOS = QoSProfile(depth=500, reliability=ReliabilityPolicy.BEST_EFFORT)


@dataclass(frozen=True)
class WatchParameters(ParameterGroup):
    """What is watched, and where it is shown."""

    estimator: str = parameter(
        'estimator_node', 'Name of the estimator node that is watched', read_only=True)
    show: str = parameter(
        'window', 'window: open the viewer; web: serve a page; else a file to write',
        read_only=True)
    follow_s: float = parameter(
        20.0, 'Seconds that the plots show', 's', minimum=0.1, read_only=True)


class WatchNode(Node):
    """Raw subscriptions into a view, which is flushed ten times a second."""

    finished = False

    def __init__(self) -> None:
        super().__init__('watch_node')
        own = build(WatchParameters, declare(self, specifications(WatchParameters)))
        self._view, self._lock = ContactView(own.estimator), Lock()
        print(f'watch: {show(self._view, own.show, own.follow_s)}', flush=True)
        self._live = LiveContact(self._view.log, own.estimator)
        self._data = RawSubscriptions(self)
        for topic, type_name, callback, latched in self._live.subscriptions():
            self._data.subscribe(topic, type_name, topics.EVENTS_QOS if latched else _QOS,
                                 self._locked(callback))
        self._thread = DataThread(self._data, self._failed)
        self.create_timer(_FLUSH_S, self._flush)

    def start(self) -> None:
        """Start watching."""
        self._thread.start()

    def stop(self) -> None:
        """Send what has been received."""
        self._thread.stop()
        if self._data.dedicated:
            self._data.take_all()
        self._view.close()

    def _locked(self, callback: Callable[[bytes], None]) -> Callable[[bytes], None]:
        def locked(raw: bytes) -> None:
            with self._lock:
                callback(raw)

        return locked

    def _flush(self) -> None:
        with self._lock:
            self._view.flush()

    def _failed(self, error: Exception) -> None:
        self.get_logger().warning(f'not shown: {error}', throttle_duration_sec=1.0)


def main(args: Sequence[str] | None = None) -> int:
    """Watch until interrupted, at a low priority that the viewer inherits."""
    if hasattr(os, 'nice'):
        os.nice(_NICENESS)
    known: Any = list(specifications(WatchParameters))
    return run_node(WatchNode, PURPOSE, known, args, topics.WRENCH)
