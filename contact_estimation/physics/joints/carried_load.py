# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Masses that a robot description has wrongly, and gravity that it has in a wrong direction."""

from __future__ import annotations

import numpy as np

from .joint_effect import JointEffect, JointMotion, Place
from ..numeric import Array
from ...kinematics.arm_dynamics import PER_LINK

_CENTRE, _GYRATION = 0.15, 0.03  # [m], [m^2]: of what an arm carries, per mass
_INERTIAL = (('mass', 'kg'), ('mc_x', 'kg m'), ('mc_y', 'kg m'), ('mc_z', 'kg m'),
             ('I_xx', 'kg m^2'), ('I_xy', 'kg m^2'), ('I_yy', 'kg m^2'), ('I_xz', 'kg m^2'),
             ('I_yz', 'kg m^2'), ('I_zz', 'kg m^2'))


def typical_inertial(mass: float) -> Array:
    """Return the size of the ten parameters of a body of some mass, shape (10,)."""
    return mass * np.array([1.0] + 3 * [_CENTRE] + 6 * [_GYRATION])


class LinkInertia(JointEffect):
    """Y_i theta: mass, first moments and inertia that a link has beyond the description."""

    name = 'link_inertia'
    family = 'load'
    place = 'link'
    equation = "tau += Y_i(q, q', q'') (mass, mass c, I)"
    coefficients = _INERTIAL

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return the regressor of one link, in all joints; see `JointEffect.columns`."""
        i = PER_LINK * place
        return {j: motion.regressor[:, j, i:i + PER_LINK] for j in range(motion.q.shape[1])}

    @classmethod
    def typical(cls, motion: JointMotion, place: Place) -> Array:
        """Return the parameters of a third of the link."""
        masses = motion.arm.masses
        return typical_inertial(0.3 * max(masses[place], 0.2 * masses.mean()))


class Payload(LinkInertia):
    """Y_n theta: what the flange carries, or lacks, beyond the description."""

    name = 'payload'
    equation = "tau += Y_n(q, q', q'') (mass, mass c, I)"

    @classmethod
    def typical(cls, motion: JointMotion, place: Place) -> Array:
        """Return the parameters of a body as heavy as the last link or half the mean one."""
        masses = motion.arm.masses
        return typical_inertial(max(masses[-1], 0.5 * masses.mean()))


class BaseTilt(JointEffect):
    """Gravity that is turned by small angles against the base."""

    name = 'base_tilt'
    family = 'robot'
    place = 'arm'
    equation = 'tau += dg(q)/d(angles) angles'
    coefficients: tuple[tuple[str, str], ...] = (('about_y', 'rad'), ('about_minus_x', 'rad'))

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return the change of gravity per angle; see `JointEffect.columns`."""
        tilt = motion.arm.tilt(motion.q)
        return {j: tilt[:, j] for j in range(tilt.shape[1])}

    @classmethod
    def typical(cls, motion: JointMotion, place: Place) -> Array:
        """Return 3 degrees."""
        return np.full(2, np.radians(3.0))
