# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Subscriptions with the reliability that the publishers of their topics offer."""

from __future__ import annotations

from typing import Any, Callable

from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy

from .data_thread import RawSubscriptions

_BEST_EFFORT, _RELIABLE = ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE


class MatchedSubscriptions:
    """
    Raw subscriptions that lose nothing of reliable publishers and refuse no other.

    A best-effort subscription matches any publisher, but on a busy machine loses messages of
    reliable ones too. A reliable one gets nothing from a best-effort publisher. So each topic is
    subscribed to once its publishers are known, reliably if all of them are, and anew when the
    first comes that is not.
    """

    def __init__(
        self, node: Node, data: RawSubscriptions, caught_up: Callable[[], None], depth: int
    ) -> None:
        self._node, self._data, self._caught_up, self._depth = node, data, caught_up, depth
        self._wanted: dict[str, tuple[str, Callable[[bytes], None]]] = {}
        self._present: dict[str, Any] = {}

    def add(self, topic: str, type_name: str, callback: Callable[[bytes], None]) -> None:
        """Want a topic; parameters as of `RawSubscriptions.subscribe`."""
        self._wanted[topic] = type_name, callback

    def match(self) -> None:
        """Look for publishers; to be called again and again."""
        for topic in self._wanted:
            offered = [info.qos_profile.reliability for info in
                       self._node.get_publishers_info_by_topic(
                           self._node.resolve_topic_name(topic))]
            reliable = all(one == _RELIABLE for one in offered)
            present = self._present.get(topic)
            if present is None:
                if offered:
                    self._subscribe(topic, reliable, overrides=True)
            elif present.qos_profile.reliability == _RELIABLE and not reliable:
                self._data.forget(present)
                self._caught_up()
                self._node.destroy_subscription(present)
                self._subscribe(topic, reliable, overrides=False)

    def _subscribe(self, topic: str, reliable: bool, overrides: bool) -> None:
        type_name, callback = self._wanted[topic]
        qos = QoSProfile(depth=self._depth, reliability=_RELIABLE if reliable else _BEST_EFFORT)
        self._present[topic] = self._data.subscribe(
            topic, type_name, qos, callback, overrides=overrides)
