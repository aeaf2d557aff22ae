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

"""Drives, gears and sensors of joints, and what is fixed to them."""

from __future__ import annotations

import numpy as np

from .joint_effect import JointEffect, JointMotion, Place
from .joint_friction import sign
from ..numeric import Array


class RotorInertia(JointEffect):
    """I_r q'': rotor and gears, which a robot description lacks."""

    name = 'reflected_inertia'
    family = 'inertia'
    equation = "tau += I_r q''"
    coefficients: tuple[tuple[str, str], ...] = (('I_r', 'kg m^2'),)
    dissipates = True  # energy is only stored, and never negative

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return q''; see `JointEffect.columns`."""
        return {place: motion.a[:, place][:, None]}


class TorqueGain(JointEffect):
    """Measured torque (1 + gain) times that of the joint: motor constant, gear ratio."""

    name = 'force_gain'
    family = 'sensor_gain'
    equation = 'tau += gain load'
    coefficients: tuple[tuple[str, str], ...] = (('gain', '1'),)

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return the torque of the description; see `JointEffect.columns`."""
        return {place: motion.load[:, place][:, None]}

    @classmethod
    def typical(cls, motion: JointMotion, place: Place) -> Array:
        """Return 0.3: published gains of one arm differ by as much."""
        return np.array([0.3])


class TorqueBias(JointEffect):
    """Zero of the torque of a joint."""

    name = 'force_bias'
    family = 'sensor_zero'
    equation = 'tau += bias'
    coefficients: tuple[tuple[str, str], ...] = (('bias', 'N m'),)

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return ones; see `JointEffect.columns`."""
        return {place: np.ones((len(motion.q), 1))}


class JointSpring(JointEffect):
    """K (q - q_0): a cable, a hose or a spring at a joint; K q_0 is a zero of the torque."""

    name = 'joint_spring'
    family = 'elastic_law'
    equation = 'tau += K (q - q_0)'
    coefficients: tuple[tuple[str, str], ...] = (('K', 'N m/rad'),)
    dissipates = True

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return q - q_0; see `JointEffect.columns`."""
        return {place: (motion.q[:, place] - motion.middle[place])[:, None]}


class Counterbalance(JointSpring):
    """A sin q + B cos q: a counterweight, or a spring across a joint."""

    name = 'counterbalance'
    equation = 'tau += A sin(q) + B cos(q)'
    coefficients: tuple[tuple[str, str], ...] = (('A', 'N m'), ('B', 'N m'))
    dissipates = False

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return sine and cosine of q; see `JointEffect.columns`."""
        q = motion.q[:, place]
        return {place: np.stack([np.sin(q), np.cos(q)], axis=1)}


class PolynomialSpring(JointSpring):
    """K d + K_2 d^2 + K_3 d^3 with d = q - q_0."""

    name = 'polynomial_stiffness'
    equation = 'tau += K d + K_2 d^2 + K_3 d^3, d = q - q_0'
    coefficients: tuple[tuple[str, str], ...] = (
        ('K', 'N m/rad'), ('K_2', 'N m/rad^2'), ('K_3', 'N m/rad^3'))
    dissipates = False
    is_curve = True

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return powers of d; see `JointEffect.columns`."""
        d = motion.q[:, place] - motion.middle[place]
        return {place: np.stack([d, d**2, d**3], axis=1)}


class FlexibleJoint(JointEffect):
    """
    The link lags behind the measured motor by compliance times the torque.

    tau = RNEA(q - C load), to first order in C (Spong, J. Dynamic Systems, Measurement, and
    Control 109(4), 1987, with the motor's inertia in `reflected_inertia`).

    """

    name = 'joint_flexibility'
    family = 'inertia'
    group = 'transmission'
    equation = 'tau = RNEA(q - compliance load_j)'
    coefficients: tuple[tuple[str, str], ...] = (('compliance', 'rad/(N m)'),)
    dissipates = True
    _TYPICAL = 0.01  # largest deflection of a gear [rad]

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return the change of RNEA per compliance, in all joints; see `JointEffect.columns`."""
        small = 1e-4 / (np.abs(motion.carried[:, place]).max() + 1e-12)
        change = motion.moved(place, small * motion.carried[:, place])
        return {j: change[:, j][:, None] / small for j in range(change.shape[1])}

    @classmethod
    def typical(cls, motion: JointMotion, place: Place) -> Array:
        """Return the compliance that deflects by 0.01 rad at the largest torque."""
        return np.array([cls._TYPICAL / (np.abs(motion.carried[:, place]).max() + 1e-12)])


class LinkSideEncoder(FlexibleJoint):
    """
    The motor leads the measured link by compliance times the torque.

    tau = RNEA(q) + I_r (q + C load)'': the motor's inertia feels the second derivative.

    """

    equation = "tau += I_r (compliance load)''"
    coefficients: tuple[tuple[str, str], ...] = (('I_r compliance', 's^2'),)

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return the second derivative of the torque; see `JointEffect.columns`."""
        return {place: motion.rate(motion.rate(motion.carried[:, place]))[:, None]}

    @classmethod
    def typical(cls, motion: JointMotion, place: Place) -> Array:
        """Return that of a drive which resonates at 10 Hz, the least that is built."""
        return np.array([(2.0 * np.pi * 10.0) ** -2])


class Backlash(FlexibleJoint):
    """The link lags behind the measured motor by half a gap, to the side that the load presses."""

    name = 'backlash'
    family = 'clearance'
    equation = 'tau = RNEA(q - gap / 2 sgn(load_j))'
    coefficients: tuple[tuple[str, str], ...] = (('gap', 'rad'),)

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return the change of RNEA per gap, in all joints; see `JointEffect.columns`."""
        load, small = motion.carried[:, place], 1e-4
        side = sign(load, 0.1 * float(np.sqrt(np.mean(load**2))) + 1e-12)
        change = motion.moved(place, small * 0.5 * side)
        return {j: change[:, j][:, None] / small for j in range(change.shape[1])}

    @classmethod
    def typical(cls, motion: JointMotion, place: Place) -> Array:
        """Return 0.01 rad."""
        return np.array([cls._TYPICAL])


class TorqueDelay(JointEffect):
    """tau(t - delay): torques are stamped later than positions, or earlier if negative."""

    name = 'force_delay'
    family = 'timing'
    place = 'arm'
    equation = 'tau(t) = load(t - delay)'
    coefficients: tuple[tuple[str, str], ...] = (('delay', 's'),)

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return the rate of the torque; see `JointEffect.columns`."""
        rate = -motion.rate(motion.load)
        return {j: rate[:, j][:, None] for j in range(rate.shape[1])}

    @classmethod
    def typical(cls, motion: JointMotion, place: Place) -> Array:
        """Return 10 ms."""
        return np.array([0.01])
