# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
A ROS node of the test that listens and calls services.

Importing this module skips a test module where there is no ROS.

"""

from itertools import count
import os
import time
from typing import Any, Callable

import pytest

rclpy = pytest.importorskip('rclpy')

from rclpy.executors import SingleThreadedExecutor  # noqa: E402,I100
from rclpy.qos import QoSProfile  # noqa: E402
from ros_messages import stamp_of  # noqa: E402
from ros_processes import DOMAIN, PATIENCE_S  # noqa: E402

DEEP_QOS = QoSProfile(depth=2000)
_NUMBERS = count()


class Listener:
    """A ROS node of the test, spun only while it waits for something."""

    def __init__(self) -> None:
        os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=DOMAIN)
        name = f'test_{os.getpid()}_{next(_NUMBERS)}'
        self.node = rclpy.create_node(name, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        # Messages of each topic by their stamps [ns], or by number where the type has no header.
        self.heard: dict[str, dict[int, Any]] = {}
        self._clients: dict[str, Any] = {}

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def listen(self, name: str, message_type: Any, topic: str, qos: Any = DEEP_QOS) -> Any:
        """Keep all messages of a topic under a name."""
        kept = self.heard.setdefault(name, {})

        def keep(message: Any) -> None:
            has_header = hasattr(message, 'header') and name != 'diagnostics'
            kept[stamp_of(message.header.stamp) if has_header else len(kept)] = message

        return self.node.create_subscription(message_type, topic, keep, qos)

    def spin_until(self, condition: Callable[[], Any], what: str) -> None:
        """Serve this node until a condition holds."""
        give_up = time.monotonic() + PATIENCE_S
        while not condition():
            assert time.monotonic() < give_up, f'waited in vain for {what}'
            self._executor.spin_once(timeout_sec=0.1)

    def call(self, service_type: Any, name: str, request: Any) -> Any:
        """Call a service and wait for its answer."""
        future = self.begin_call(service_type, name, request)
        self.spin_until(future.done, f'the answer of {name}')
        return future.result()

    def begin_call(self, service_type: Any, name: str, request: Any) -> Any:
        """Call a service without waiting for its answer."""
        if name not in self._clients:
            self._clients[name] = self.node.create_client(service_type, name)
        client = self._clients[name]
        self.spin_until(client.service_is_ready, f'service {name}')
        return client.call_async(request)
