# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Messages that a test sends to the estimator node, and what a session makes of the same samples.

Importing this module skips a test module where there is no ROS; the types of messages that tests
need are imported from here, therefore.

"""

from math import nan
from typing import Any, Iterable, Sequence

from contact_estimation.parameters import build
from contact_estimation.pipeline.axes import Result
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.signals.contact_sample import ContactSample
import pytest

pytest.importorskip('rclpy')

from builtin_interfaces.msg import Time  # noqa: E402,I100
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402,F401
from geometry_msgs.msg import PoseStamped, Vector3Stamped, WrenchStamped  # noqa: E402,F401
from sensor_msgs.msg import JointState  # noqa: E402
from std_msgs.msg import Float64, String  # noqa: E402,F401
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint  # noqa: E402

FRAME = 'tool'
JOINT = 'contact_x'


def stamp_of(time_message: Any) -> int:
    """Read a stamp [ns]."""
    return int(time_message.sec) * 1_000_000_000 + int(time_message.nanosec)


def to_stamp(stamp_ns: int) -> Any:
    """Write a stamp."""
    sec, nanosec = divmod(stamp_ns, 1_000_000_000)
    return Time(sec=sec, nanosec=nanosec)


def wrench(stamp_ns: int, force: float, frame_id: str = FRAME) -> Any:
    """Make a wrench whose other axes could not be mistaken for the contact."""
    message = WrenchStamped()
    message.header.stamp, message.header.frame_id = to_stamp(stamp_ns), frame_id
    message.wrench.force.x, message.wrench.force.y = force, 7.0
    return message


def joint_state(
    stamp_ns: int, position: float, velocity: float, names: Sequence[str] = (JOINT,)
) -> Any:
    """Make a joint state of one axis."""
    message = JointState(name=list(names), position=[position], velocity=[velocity])
    message.header.stamp = to_stamp(stamp_ns)
    return message


def trajectory(
    stamp_ns: int, position: float, effort: float = nan, velocity: float = 0.0,
    acceleration: float = 0.0,
) -> Any:
    """Make a trajectory of one point; no effort where it is NaN."""
    point = JointTrajectoryPoint(
        positions=[position], velocities=[velocity], accelerations=[acceleration],
        effort=[] if effort != effort else [effort])
    message = JointTrajectory(joint_names=[JOINT], points=[point])
    message.header.stamp = to_stamp(stamp_ns)
    return message


def moved(samples: Iterable[ContactSample], begin_ns: int) -> list[ContactSample]:
    """Shift stamps."""
    return [sample._replace(stamp_ns=sample.stamp_ns + begin_ns) for sample in samples]


def session_results(samples: Iterable[ContactSample], **parameters: Any) -> list[Result]:
    """Pass samples through a fresh session without ROS; double underscores stand for dots."""
    names = {name.replace('__', '.'): value for name, value in parameters.items()}
    session = ContactSession(build(EstimationParameters, names))
    results: list[Result] = []
    for stamp_ns, position, velocity, force in samples:
        results += session.add_motion(stamp_ns, position, velocity)
        results += session.add_wrench(stamp_ns, force)
    return results
