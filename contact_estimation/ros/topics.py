# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Names, types, message classes and quality of service of the topics."""

from functools import lru_cache
from importlib import import_module
from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

from ..kinematics.frame_tree import TRANSFORMS_TYPE

WRENCH = 'wrench'
JOINT_STATES = 'joint_states'
DESIRED = 'desired_trajectory'
REFERENCE = 'reference_trajectory'
ROBOT_DESCRIPTION = 'robot_description'
TF, TF_STATIC = '/tf', '/tf_static'
DIAGNOSTICS = '/diagnostics'

FLOAT64 = 'std_msgs/msg/Float64'
STRING = 'std_msgs/msg/String'
VECTOR3 = 'geometry_msgs/msg/Vector3Stamped'
WRENCH_TYPE = 'geometry_msgs/msg/WrenchStamped'
JOINTS_TYPE = 'sensor_msgs/msg/JointState'
TRAJECTORY = 'trajectory_msgs/msg/JointTrajectory'

INPUT_QOS = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
"""Matches any publisher; deep, so that no message is dropped while the machine stalls."""

OUTPUT_QOS = QoSProfile(depth=250, reliability=ReliabilityPolicy.RELIABLE)
"""
Half a second at 500 Hz, so that what a busy recorder missed can be sent to it again.

Readers acknowledge every 3 s, and Fast DDS then drops the history in one go, 10 us a sample of all
topics together. Until it is done, the process receives nothing: 10 to 20 ms at a depth of 1000.
"""


def _latched(depth: int) -> QoSProfile:
    return QoSProfile(depth=depth, reliability=ReliabilityPolicy.RELIABLE,
                      durability=DurabilityPolicy.TRANSIENT_LOCAL)


DESCRIPTION_QOS = _latched(1)
"""As of robot_state_publisher, which publishes the description once."""

EVENTS_QOS = _latched(1000)
"""A late recorder still receives the initial parameters and every change since."""

STATUS_QOS = _latched(1)
"""The status is published on change: a late subscriber receives the last one."""

TF_STATIC_QOS = _latched(100)
"""As of tf2: every publisher of static transforms publishes once."""


def overridable() -> QoSOverridingOptions:
    """Return the options that let parameters `qos_overrides.TOPIC...` change the QoS."""
    return QoSOverridingOptions.with_default_policies()


def has_transforms() -> bool:
    """Return whether the messages of tf are installed, which rclpy does not need."""
    try:
        message_class(TRANSFORMS_TYPE)
    except ImportError:
        return False
    return True


@lru_cache(maxsize=None)
def message_class(type_name: str) -> Any:
    """Import the class of a message type."""
    package, kind, name = type_name.split('/')
    return getattr(import_module(f'{package}.{kind}'), name)
