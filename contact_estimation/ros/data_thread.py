# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
A thread that waits on just the data subscriptions.

rclpy's executors rebuild their wait set for every message, which takes longer than the
estimation. This thread keeps one wait set for the data alone and takes raw bytes; parameters,
services and timers stay on an ordinary executor. The wait set is not public API of rclpy: where
it is missing, the subscriptions are left to the executor, with a warning. All use of that API is
in this module.
"""

from threading import Event, Thread
from typing import Any, Callable

from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.qos import QoSProfile

from .topics import message_class, overridable

try:
    from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

    _WaitSet: Any = _rclpy.WaitSet
    HAS_WAIT_SET = hasattr(_rclpy.Subscription, 'take_message')
except (ImportError, AttributeError):  # pragma: no cover - another rclpy than Jazzy's
    HAS_WAIT_SET = False

Callback = Callable[[bytes], None]
_TIMEOUT_S = 5.0  # of a caller that waits for a thread on a busy machine
_WAKE_NS = 100_000_000  # so that a stop is noticed without traffic


class _NeverByExecutor(CallbackGroup):
    """Keeps subscriptions out of the executor's wait set."""

    def can_execute(self, entity: Any) -> bool:
        return False

    def beginning_execution(self, entity: Any) -> bool:
        return False

    def ending_execution(self, entity: Any) -> None:
        pass


class RawSubscriptions:
    """Raw subscriptions of a node, waited on together."""

    def __init__(self, node: Node, dedicated: bool = True) -> None:
        self._node = node
        self.dedicated = dedicated and HAS_WAIT_SET
        if dedicated and not HAS_WAIT_SET:
            node.get_logger().warning(
                'this rclpy has no WaitSet to use directly; data is served by the executor, at '
                'several times the CPU load')
        self._group = _NeverByExecutor() if self.dedicated else None
        # Replaced, never changed: another thread may be going through them.
        self._waking: list[tuple[Any, Callback]] = []
        self._quiet: list[tuple[Any, Callback]] = []
        self._wait_set: Any = None
        self._capacity = 0

    def subscribe(
        self, topic: str, type_name: str, qos: QoSProfile, callback: Callback, wakes: bool = True,
        overrides: bool = False,
    ) -> Any:
        """Subscribe to a topic; the callback gets the serialised message."""
        subscription = self._node.create_subscription(
            message_class(type_name), topic, callback, qos, raw=True, callback_group=self._group,
            qos_overriding_options=overridable() if overrides else None)
        if wakes:
            self._waking = [*self._waking, (subscription, callback)]
        else:
            self._quiet = [*self._quiet, (subscription, callback)]
        return subscription

    def forget(self, subscription: Any) -> None:
        """Serve a subscription no more; once the thread has caught up, it may be destroyed."""
        self._waking, self._quiet = (
            [each for each in kept if each[0] is not subscription]
            for kept in (self._waking, self._quiet))

    def wait(self, timeout_ns: int) -> None:
        """Wait for messages, up to a time [ns], and pass them to their callbacks."""
        waking = self._waking
        if self._wait_set is None or self._capacity < len(waking):
            self._capacity = len(waking)
            self._wait_set = _WaitSet(self._capacity, 0, 0, 0, 0, 0, self._node.context.handle)
        wait_set = self._wait_set
        wait_set.clear_entities()
        for subscription, _ in waking:
            wait_set.add_subscription(subscription.handle)
        wait_set.wait(max(0, timeout_ns))
        ready = [place for place in range(len(waking)) if wait_set.is_ready('subscription', place)]
        if ready:
            self._take_all(self._quiet)
        for place in ready:
            subscription, callback = waking[place]
            taken = subscription.handle.take_message(subscription.msg_type, True)
            if taken is not None:
                callback(taken[0])

    def take_all(self) -> None:
        """Pass all queued messages to their callbacks, without waiting."""
        self._take_all(self._quiet)
        self._take_all(self._waking)

    @staticmethod
    def _take_all(subscriptions: list[tuple[Any, Callback]]) -> None:
        for subscription, callback in subscriptions:
            take, message_type = subscription.handle.take_message, subscription.msg_type
            taken = take(message_type, True)
            while taken is not None:
                callback(taken[0])
                taken = take(message_type, True)


class DataThread:
    """Serve raw subscriptions on a dedicated thread until stopped."""

    def __init__(
        self, subscriptions: RawSubscriptions, on_error: Callable[[Exception], None]
    ) -> None:
        self._subscriptions, self._on_error = subscriptions, on_error
        self._stop, self._served = Event(), Event()
        self._served.set()
        self._thread = Thread(target=self._run, name='data', daemon=True)

    def start(self) -> None:
        """Start the thread."""
        if self._subscriptions.dedicated:
            self._thread.start()

    def stop(self) -> None:
        """Finish the current wait and stop."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def catch_up(self) -> None:
        """Wait until all that has arrived is served; not to be called by a callback of data."""
        if self._thread.is_alive():
            self._served.clear()
            self._served.wait(_TIMEOUT_S)

    def _run(self) -> None:
        context = self._subscriptions._node.context
        while not self._stop.is_set() and context.ok():
            try:
                self._subscriptions.wait(_WAKE_NS)
                if not self._served.is_set():
                    self._subscriptions.take_all()
                    self._served.set()
            except Exception as error:  # noqa: B902 - the node continues after any error
                if context.ok():
                    self._on_error(error)
