# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""An arm without a force sensor that presses on a table, as its joint states show it."""

from functools import lru_cache
from typing import Any
from xml.etree import ElementTree

from contact_estimation.kinematics.arm_dynamics import ArmDynamics
from contact_estimation.kinematics.robot_model import RobotModel
from contact_estimation.plant.arm_models import arm_description
from contact_estimation.plant.arm_simulation import (
    ArmLaw, ArmSensors, simulate_arm, SimulatedArm)
from contact_estimation.recordings.encoding import encode_arm
from contact_estimation.reference.arm_excitation import ArmTrajectory
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

K_E, B_E = 4800.0, 200.0
NORMAL = np.array([0.0, 0.0, -1.0])
START = (0.3, 0.5, 0.9, 0.2, 0.4, 0.1)
F_C = (8.0, 10.0, 6.0, 2.0, 1.5, 0.8)
B = (10.0, 12.0, 6.0, 2.0, 1.0, 0.5)
ARMATURE = (1.2, 1.5, 0.8, 0.1, 0.08, 0.05)
NOISE = np.array([0.3, 0.4, 0.2, 0.1, 0.08, 0.05])
POINT = (0.05, 0.0, 0.0)
DURATION = 6.5


def described(friction: float = 1.0, mass: float = 1.0) -> str:
    """Return the description with a share of the true friction and of the true masses."""
    root = ElementTree.fromstring(arm_description('elbow_6r'))
    moving = [one for one in root.findall('joint') if one.get('type') != 'fixed']
    for k, joint in enumerate(moving):
        ElementTree.SubElement(joint, 'dynamics', {
            'friction': str(friction * F_C[k]), 'damping': str(friction * B[k]),
            'armature': str(friction * ARMATURE[k])})
    for one in root.iter('mass'):
        one.set('value', str(mass * float(one.get('value', '0'))))
    return ElementTree.tostring(root, encoding='unicode')


def model() -> RobotModel:
    """Return the kinematics."""
    return RobotModel(described(), 'base', 'link_6')


def _point(arm: RobotModel, q: Array) -> tuple[Array, Array]:
    """Return the contact point and its Jacobian, (3,) and (3, 6)."""
    R, p = arm.pose(q)
    J, lever = arm.jacobian(q), R @ POINT
    return p + lever, J[:3] + np.cross(J[3:], lever, axis=0)


def location() -> float:
    """Return x_e [m]."""
    return float(NORMAL @ _point(model(), np.array(START))[0]) + 0.02


@lru_cache(maxsize=1)
def motion() -> tuple[SimulatedArm, Array]:
    """Return joint states of a touch, and the true force along the normal."""
    arm, t = model(), np.arange(0.0, DURATION, 0.004)
    depth = np.interp(t, [0, 1, 2, 5.5, 6.3], [0, 0, 30, 30, 0])
    pressed = np.interp(t, [2, 2.5, 5, 5.5], [0, 1, 1, 0])
    wave = 2.0 * np.sin(2 * np.pi * 1.1 * t) + 1.5 * np.sin(2 * np.pi * 2.9 * t)
    path = 1e-3 * (np.convolve(np.pad(depth, 100, 'edge'), np.hanning(201) / 100, 'valid')
                   + pressed * wave)
    q, start, along = np.array(START), _point(arm, np.array(START))[0], []
    R_0 = arm.pose(q)[0]
    for x in path:
        for _ in range(2):
            here, J = _point(arm, q)
            turn = arm.pose(q)[0]
            tilt = 0.5 * sum(np.cross(turn[:, k], R_0[:, k]) for k in range(3))
            full = np.vstack([J, arm.jacobian(q)[3:]])
            q = q + np.linalg.solve(full, np.r_[start + x * NORMAL - here, tilt])
        along.append(q)
    wanted = np.array(along)
    v = np.gradient(wanted, t, axis=0)
    trajectory = ArmTrajectory(t, wanted, v, np.gradient(v, t, axis=0), 1.0)
    x_e = location()

    def force(q: Array, v: Array) -> tuple[float, Array]:
        p, J = _point(arm, q)
        rate, inside = float(NORMAL @ J @ v), float(NORMAL @ p) - x_e
        F_e = min(0.0, -(K_E * inside + B_E * rate)) if inside > 0.0 else 0.0
        return F_e, J

    def wall(q: Array, v: Array) -> Array:
        F_e, J = force(q, v)
        return np.asarray(J.T @ NORMAL * F_e)

    laws = [law for j in range(6) for law in (
        ArmLaw('coulomb_friction', [F_C[j]], j, 0.01), ArmLaw('viscous_friction', [B[j]], j),
        ArmLaw('reflected_inertia', [ARMATURE[j]], j))]
    found = simulate_arm(ArmDynamics(arm_description('elbow_6r')), trajectory, laws,
                         ArmSensors(500.0, NOISE), 1, wall)
    return found, np.array([force(*row)[0] for row in zip(found.q, found.v)])


def parameters(**changes: Any) -> dict[str, Any]:
    """Return parameters of the estimator."""
    return {'wrench_source': 'joint_efforts', 'kinematics.base': 'base',
            'kinematics.tip': 'link_6', 'contact.normal': NORMAL.tolist(),
            'contact.point': list(POINT), 'environment.location': location(), 'sample_rate': 100.0,
            'conditioning.cutoff_frequency': 20.0, **changes}


@lru_cache(maxsize=2)
def messages(with_velocity: bool = True) -> list[tuple[int, bytes]]:
    """Return stamp and content of each joint state, beside a finger's."""
    arm, _ = motion()
    names = ['finger', *model().joint_names]
    rows = []
    for t, q, v, tau in zip(arm.t, arm.q, arm.v, arm.tau):
        stamp_ns = 1_000_000_000 + round(1e9 * t)
        rows.append((stamp_ns, encode_arm(
            stamp_ns, names, np.r_[0.01, q], np.r_[0.0, v] if with_velocity else np.zeros(0),
            np.r_[0.0, tau])))
    return rows
