# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A small arm: kinematics by hand-written transforms, and messages as it presses on a wall."""

from functools import lru_cache
from typing import Any, NamedTuple, Sequence

from contact_estimation.kinematics.robot_model import RobotModel
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples
import numpy as np
from numpy.typing import NDArray
import pytest
from reference_messages import joint_state_bytes, transforms_bytes, wrench_bytes
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

# Link, parent, joint, type, xyz, rpy, axis.
_LINKS = (
    ('base_link', 'world', 'mount', 'fixed', (0.1, 0.2, 0.3), (0.1, 0.2, 0.3), (1, 0, 0)),
    ('link_1', 'base_link', 'shoulder', 'revolute', (0, 0, 0.3), (0, 0, 0), (0, 0, 1)),
    ('link_2', 'link_1', 'elbow', 'continuous', (0.1, 0, 0.1), (0.2, 0, 0), (0, 1, 0)),
    ('link_3', 'link_2', 'wrist', 'revolute', (0.4, 0, 0), (0, 0.3, 0), (0, 0.6, 0.8)),
    ('sensor', 'link_3', 'sensor_mount', 'fixed', (0.3, 0, 0), (0, 1.2, 0), (1, 0, 0)),
    ('tool', 'sensor', 'tool_mount', 'fixed', (0, 0, 0.1), (0, 0, 0.4), (1, 0, 0)),
    ('finger', 'tool', 'finger_joint', 'prismatic', (0, 0, 0.1), (0, 0, 0), (0, 1, 0)),
)
JOINTS = ('shoulder', 'elbow', 'wrist')
MOVING = ('link_1', 'link_2', 'link_3', 'finger')
FIXED = ('base_link', 'sensor', 'tool')
_LIMITS = '<limit lower="-3" upper="3" effort="100" velocity="10"/>'


def urdf() -> str:
    """Return the description."""
    joints = ''.join(
        f'<link name="{link}"/><joint name="{name}" type="{kind}"><parent link="{parent}"/>'
        f'<child link="{link}"/><origin xyz="{_text(xyz)}" rpy="{_text(rpy)}"/>'
        f'<axis xyz="{_text(axis)}"/>{_LIMITS}</joint>'
        for link, parent, name, kind, xyz, rpy, axis in _LINKS)
    return f'<robot name="small_arm"><link name="world"/>{joints}</robot>'


def pose(q: Sequence[float], link: str = 'tool', base: str = 'base_link') -> Array:
    """Return the homogeneous transform (4, 4) from a link to the base."""
    T, here = np.eye(4), link
    while here != base:
        here, own = step(q, here)
        T = own @ T
    return T


def step(q: Sequence[float], link: str) -> tuple[str, Array]:
    """Return the parent of a link, and the homogeneous transform (4, 4) from the link to it."""
    angles = dict(zip(JOINTS, q))
    _, parent, name, _, xyz, rpy, axis = next(row for row in _LINKS if row[0] == link)
    own = np.eye(4)
    turned = Rotation.from_rotvec(np.array(axis) * angles.get(name, 0.0))
    own[:3, :3] = (Rotation.from_euler('xyz', rpy) * turned).as_matrix()
    own[:3, 3] = xyz
    return parent, own


def _text(numbers: Sequence[float]) -> str:
    return ' '.join(str(number) for number in numbers)


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


def swung(k: int, mass: float, zero: Sequence[float], axes: str) -> tuple[Array, Array]:
    """Return the joints of an arm that swings in free flight, and the force measured [N]."""
    amplitude, phase = np.array([0.8, 0.5, 1.2]), np.array([0.0, 1.0, 2.0])
    q: Array = START + amplitude * np.sin(0.01 * k * (1.0 + 0.3 * phase) + phase)
    weight = pose(tuple(q), 'sensor', 'world')[:3, :3].T @ [0.0, 0.0, -9.80665 * mass]
    force = weight + zero + np.random.default_rng(k).normal(0.0, 0.3, 3)
    return q, force if axes == 'sensor' else pose(tuple(q), 'sensor')[:3, :3] @ force


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
                    [0.0, *q_dot[part]], stamp_ns=stamp_ns)
                listed.append(('/joint_states', stamp_ns, raw))
        force, torque = wrench[:3].tolist(), wrench[3:].tolist()
        raw = wrench_bytes(force, torque, stamp_ns=stamp_ns, frame_id='sensor')
        listed.append(('/wrench', stamp_ns, raw))
    return listed


OF_TF: dict[str, Any] = {**PARAMETERS, 'pose_source': 'tf'}


def transform(q: Any, link: str, stamp_ns: int = 0) -> tuple[int, str, str, Any]:
    """Return stamp, parent, child and pose of a link."""
    parent, T = step(q, link)
    turned = Rotation.from_matrix(T[:3, :3]).as_quat()
    return stamp_ns, parent, link, (*T[:3, 3].tolist(), *turned.tolist())


def static_bytes(links: Sequence[str] = FIXED) -> bytes:
    return transforms_bytes([transform((0.0, 0.0, 0.0), link) for link in links])


@lru_cache(maxsize=None)
def tf_messages(every: int = 1, split: bool = False) -> list[tuple[str, int, bytes]]:
    """
    Return topic, stamp and content of all messages, transforms in place of joint states.

    Transforms are given with every so many wrenches, in one message or from two publishers of
    which the second comes late.
    """
    listed = [('/tf_static', 0, static_bytes())]
    truth = {one.contact.stamp_ns: one.q for one in instants()}
    wrenches = [m for m in messages() if m[0] == '/wrench']
    for number, (topic, stamp_ns, raw) in enumerate(wrenches):
        if number % every == 0:
            parts = [MOVING[:2], MOVING[2:]] if split else [MOVING]
            for part in parts:
                listed.append(('/tf', stamp_ns, transforms_bytes(
                    [transform(truth[stamp_ns], link, stamp_ns) for link in part])))
        listed.append((topic, stamp_ns, raw))
    return listed
