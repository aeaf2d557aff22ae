# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The small arm pressing on a tilted wall, as the messages that its drivers would publish."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

from contact_estimation.kinematics.robot_model import RobotModel
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples
import numpy as np
from numpy.typing import NDArray
import pytest
from reference_messages import joint_state_bytes, wrench_bytes
from small_arm import JOINTS, pose, urdf

Array = NDArray[np.float64]

K_E, B_E = 4800.0, 200.0
NORMAL = np.array([0.6, 0.0, -0.8])
START = (0.4, 0.5, 0.6)
MASS, CENTRE = 1.2, np.array([0.01, -0.02, 0.06])
LOCATION = float(NORMAL @ pose(START)[:3, 3]) + 0.01  # the samples rest 10 mm before the wall
PARAMETERS: dict[str, Any] = {
    'kinematics.base': 'base_link', 'kinematics.tip': 'tool', 'contact.normal': [3.0, 0.0, -4.0],
    'tool.mass': MASS, 'tool.centre': CENTRE.tolist(), 'environment.location': LOCATION,
    'estimator': 'kalman',
}


class Instant(NamedTuple):
    """Truth at one instant: contact, joints and the wrench that the sensor measures."""

    contact: ContactSample
    q: Array
    q_dot: Array
    wrench: Array


@lru_cache(maxsize=None)
def instants(contact_s: float = 1.5) -> tuple[Instant, ...]:
    """Move the tool along the normal as `contact_samples` say; 3 N of drag along the wall."""
    pytest.importorskip('pinocchio')
    model = RobotModel(urdf(), 'base_link', 'tool')
    start = pose(START)[:3, 3]
    drag = 3.0 * np.array([0.8, 0.0, 0.6])
    q, found = np.array(START), []
    for sample in contact_samples(contact_s, K_E, B_E, force_noise=0.3):
        target = start + NORMAL * (sample.position + 0.01)
        for _ in range(3):
            q = q + np.linalg.solve(model.jacobian(q)[:3], target - model.pose(q)[1])
        q_dot = np.linalg.solve(model.jacobian(q)[:3], NORMAL * sample.velocity)
        force = NORMAL * sample.force + drag * (sample.force < -5.0)
        to_sensor = pose(tuple(q), 'sensor')[:3, :3].T
        weight = pose(tuple(q), 'sensor', 'world')[:3, :3].T @ [0.0, 0.0, -9.80665 * MASS]
        wrench: Array = np.r_[to_sensor @ force + weight, np.cross(CENTRE, weight)]
        found.append(Instant(sample, q, np.asarray(q_dot, float), wrench))
    return tuple(found)


@lru_cache(maxsize=None)
def messages(every: int = 1, split: bool = False) -> list[tuple[str, int, bytes]]:
    """
    Return topic, stamp and content of all messages.

    Joint states are given with every so many wrenches, in an order that changes, and beside a
    finger; or split over two messages.
    """
    listed = []
    for number, (contact, q, q_dot, wrench) in enumerate(instants()):
        stamp_ns = contact.stamp_ns
        if number % every == 0:
            order = np.roll([0, 1, 2], number // every)
            parts = [order[:2], order[2:]] if split else [order]
            for part in parts:
                raw = joint_state_bytes(
                    ['finger_joint', *(JOINTS[k] for k in part)], [0.02, *q[part]],
                    [0.0, *q_dot[part]], stamp_ns=stamp_ns,
                )
                listed.append(('/joint_states', stamp_ns, raw))
        force, torque = wrench[:3].tolist(), wrench[3:].tolist()
        raw = wrench_bytes(force, torque, stamp_ns=stamp_ns, frame_id='sensor')
        listed.append(('/wrench', stamp_ns, raw))
    return listed
