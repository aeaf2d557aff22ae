# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Masses that a robot description has wrongly, and gravity that it has in a wrong direction."""

import numpy as np

from .joint_effect import JointEffect, JointMotion, Place
from .numeric import Array
from ..kinematics.arm_dynamics import PER_LINK

_CENTRE, _GYRATION = 0.15, 0.03  # [m], [m^2]: of what an arm carries, per mass
_TOOL = 2.0  # reach of a long one, in that of a link
_TILT = np.radians(3.0)
_WRENCH = np.array(3 * [20.0] + 3 * [2.0])  # zero of a sensor that was never tared [N], [N m]
_INERTIAL = (('mass', 'kg'), ('mc_x', 'kg m'), ('mc_y', 'kg m'), ('mc_z', 'kg m'),
             ('I_xx', 'kg m^2'), ('I_xy', 'kg m^2'), ('I_yy', 'kg m^2'), ('I_xz', 'kg m^2'),
             ('I_yz', 'kg m^2'), ('I_zz', 'kg m^2'))


def typical_inertial(mass: float, reach: float = 1.0) -> Array:
    """Return the size of the ten parameters of a body of some mass, shape (10,)."""
    return mass * np.array([1.0] + 3 * [reach * _CENTRE] + 6 * [reach**2 * _GYRATION])


def _of_link(motion: JointMotion, i: int, shape: float) -> dict[int, Array]:
    first = PER_LINK * i
    return {j: motion.regressor[:, j, first:first + PER_LINK] for j in range(motion.q.shape[1])}


def _of_tilt(motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
    tilt = motion.arm.tilt(motion.q)
    return {j: tilt[:, j] for j in range(tilt.shape[1])}


def _of_wrench(motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
    assert motion.outside is not None
    J = motion.arm.jacobian(motion.q, motion.outside.frame)
    return {j: J[:, :, j] for j in range(J.shape[2])}


def _of_felt(motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
    felt = motion.felt
    return {j: -felt[:, j, None] for j in range(felt.shape[1])}


def _third_of_link(motion: JointMotion, i: int) -> Array:
    masses = motion.arm.masses
    return typical_inertial(0.3 * max(masses[i], 0.2 * masses.mean()))


def _body(motion: JointMotion, i: int) -> Array:
    """Return the size of a tool as heavy as the last link, or half the mean one."""
    masses = motion.arm.masses
    return typical_inertial(max(masses[-1], 0.5 * masses.mean()), _TOOL)


LOAD = (
    # What the flange carries, or lacks, beyond the description.
    JointEffect(
        'payload', 'load', "tau += Y_n(q, q', q'') (mass, mass c, I)", _INERTIAL, _of_link,
        place='link', typical=_body),
    JointEffect(
        'link_inertia', 'load', "tau += Y_i(q, q', q'') (mass, mass c, I)", _INERTIAL, _of_link,
        place='link', typical=_third_of_link),
    JointEffect(
        'base_tilt', 'robot', 'tau += dg(q)/d(angles) angles',
        (('about_y', 'rad'), ('about_minus_x', 'rad')), _of_tilt, place='arm',
        typical=lambda motion, place: np.full(2, _TILT)),
    # The zero of a sensor of force and torque, whose wrench is taken out of the torques.
    JointEffect(
        'wrench_bias', 'sensor_zero', 'tau += J^T bias',
        (('F_x', 'N'), ('F_y', 'N'), ('F_z', 'N'), ('T_x', 'N m'), ('T_y', 'N m'),
         ('T_z', 'N m')), _of_wrench, place='arm', needs_wrench=True,
        typical=lambda motion, place: _WRENCH),
    JointEffect(
        'wrench_gain', 'sensor_gain', 'tau -= gain J^T F', (('gain', '1'),), _of_felt,
        place='arm', needs_wrench=True, typical=lambda motion, place: np.array([0.3])),
)
