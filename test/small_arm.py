# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A small arm: its description, and its kinematics by a product of hand-written transforms."""

from __future__ import annotations

from typing import Sequence

import numpy as np
from numpy.typing import NDArray
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
        for link, parent, name, kind, xyz, rpy, axis in _LINKS
    )
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
