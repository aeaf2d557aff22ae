# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The graph of ROS as seen by the estimator node, looked at once a second."""

from __future__ import annotations

from math import inf
import time

from rclpy.node import Node

from . import topics
from ..pipeline.checks.stream_checks import graph_warnings
from ..pipeline.session import ContactSession

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
