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

"""Friction of joints: the laws of the library at the velocity of a joint."""

from __future__ import annotations

from typing import Any

import numpy as np

from .joint_effect import JointEffect, JointMotion, Place
from ..asymmetric_damping import AsymmetricDamping, AsymmetricDampingParameters
from ..coulomb_friction import CoulombFriction, CoulombFrictionParameters
from ..numeric import Array, SIGN_VELOCITY
from ..presliding_friction import PreslidingFriction, PreslidingFrictionParameters
from ..quadratic_damping import QuadraticDamping, QuadraticDampingParameters
from ..stribeck_friction import StribeckFriction, StribeckFrictionParameters

_SHARP = 0.02  # of the speed of a joint: width of its sgn where a law has another shape


def _law(effect: Any, v: Array, per_speed: Any = 1.0) -> Array:
    """Return the resistance of a law of the library at velocities in another unit."""
    return np.asarray(effect.resistance(0.0, 0.0 * v, v * per_speed, (), np))


def sign(v: Array, width: Any) -> Array:
    """Return tanh(v / width), the sgn(v) of the library in the unit of a joint."""
    unit = CoulombFriction(CoulombFrictionParameters(F_c=1.0))
    return _law(unit, v, SIGN_VELOCITY / width)


class _DryFriction(JointEffect):
    family = 'friction'
    group = 'dry_friction'
    dissipates = True


class CoulombJoint(_DryFriction):
    """F_c sgn(q'), smooth over a share of the joint's speed: lubricated gears creep."""

    name = 'coulomb_friction'
    equation = "tau += F_c tanh(q' / width)"
    coefficients: tuple[tuple[str, str], ...] = (('F_c', 'N m'),)
    shape = ('width', 'rad/s')

    @classmethod
    def shapes(cls, motion: JointMotion, place: Place) -> tuple[float, ...]:
        """Return three widths, from sharp to that of a sigmoid."""
        return tuple(float(share * motion.speed[place]) for share in (_SHARP, 0.1, 0.3))

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return sgn(q'); see `JointEffect.columns`."""
        return {place: sign(motion.v[:, place], shape)[:, None]}


class StribeckJoint(_DryFriction):
    """(F_c + (F_s - F_c) exp(-(q' / v_s)^2)) sgn(q')."""

    name = 'stribeck_friction'
    equation = "tau += (F_c + (F_s - F_c) exp(-(q' / v_s)^2)) sgn(q')"
    coefficients: tuple[tuple[str, str], ...] = (('F_c', 'N m'), ('F_s', 'N m'))
    laws = 2
    shape = ('v_s', 'rad/s')

    @classmethod
    def shapes(cls, motion: JointMotion, place: Place) -> tuple[float, ...]:
        """Spread the Stribeck velocity over the speeds at which a joint moves."""
        return tuple(float(share * motion.speed[place]) for share in (0.1, 0.2, 0.4))

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return the law for F_c = 1 and for F_s = 1 alone; see `JointEffect.columns`."""
        per_speed = SIGN_VELOCITY / (_SHARP * motion.speed[place])
        units = (StribeckFriction(StribeckFrictionParameters(
            F_c=1.0 - k, F_s=k, v_s=float(shape * per_speed))) for k in (0.0, 1.0))
        v = motion.v[:, place]
        return {place: np.stack(
            [_law(unit, v, per_speed) for unit in units], axis=1)}

    @classmethod
    def is_possible(cls, theta: Array) -> bool:
        """Return whether friction falls with speed, and never drives."""
        return bool(0.0 <= theta[0] <= theta[1])


class PreslidingJoint(_DryFriction):
    """Dahl friction z, z' = sigma q' (1 - (z / F_c) sgn q'), driven by the position."""

    name = 'presliding_friction'
    equation = "tau += z, z' = (q' / travel) (F_c - z sgn q')"
    coefficients: tuple[tuple[str, str], ...] = (('F_c', 'N m'),)
    shape = ('travel', 'rad')

    @classmethod
    def shapes(cls, motion: JointMotion, place: Place) -> tuple[float, ...]:
        """Return the travels that gears and their lubricants have [rad]."""
        return (0.001, 0.003, 0.01, 0.03)

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return z for F_c = 1; see `JointEffect.columns`."""
        law = PreslidingFriction(PreslidingFrictionParameters(F_c=1.0, sigma=1.0 / shape))
        t = motion.period * np.arange(len(motion.q), dtype=float)
        z = law.states_along(t, motion.q[:, place], motion.v[:, place], np.ones(len(t), bool))[1]
        return {place: z[:, None]}


class LoadFriction(_DryFriction):
    """
    (F_c + mu abs(load)) sgn(q'): the teeth of a gear rub in proportion to what they carry.

    Hamon, Gautier, Garrec and Janot, IEEE/RSJ IROS, 2010.

    """

    name = 'load_dependent_friction'
    equation = "tau += (F_c + mu |load|) sgn(q')"
    coefficients: tuple[tuple[str, str], ...] = (('F_c', 'N m'), ('mu', '1'))
    laws = 2

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return sgn(q') and |load| sgn(q'); see `JointEffect.columns`."""
        s = sign(motion.v[:, place], _SHARP * motion.speed[place])
        load = np.abs(motion.load[:, place])
        return {place: np.stack([s, load * s], axis=1)}


class ViscousJoint(JointEffect):
    """B q'."""

    name = 'viscous_friction'
    family = 'friction'
    group = 'viscous_friction'
    equation = "tau += B q'"
    coefficients: tuple[tuple[str, str], ...] = (('B', 'N m s/rad'),)
    dissipates = True

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return q'; see `JointEffect.columns`."""
        return {place: motion.v[:, place][:, None]}


class QuadraticJoint(ViscousJoint):
    """B q' + B_2 q' abs(q'); B_2 < 0 for a lubricant that thins with the rate of shear."""

    name = 'quadratic_damping'
    equation = "tau += B q' + B_2 q' |q'|"
    coefficients: tuple[tuple[str, str], ...] = (('B', 'N m s/rad'), ('B_2', 'N m s^2/rad^2'))
    laws = 2

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return q' and q' |q'|; see `JointEffect.columns`."""
        v = motion.v[:, place]
        unit = QuadraticDamping(QuadraticDampingParameters(B_2=1.0))
        return {place: np.stack([v, _law(unit, v)], axis=1)}

    @classmethod
    def is_possible(cls, theta: Array) -> bool:
        """Return whether friction resists slow motion."""
        return bool(theta[0] >= 0.0)


class AsymmetricJoint(ViscousJoint):
    """B q' + B_a abs(q'), abs(B_a) <= B."""

    name = 'asymmetric_damping'
    equation = "tau += B q' + B_a |q'|"
    coefficients: tuple[tuple[str, str], ...] = (('B', 'N m s/rad'), ('B_a', 'N m s/rad'))
    laws = 2

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return q' and |q'|; see `JointEffect.columns`."""
        v = motion.v[:, place]
        unit = AsymmetricDamping(AsymmetricDampingParameters(B_a=1.0))
        return {place: np.stack([v, _law(unit, v)], axis=1)}

    @classmethod
    def is_possible(cls, theta: Array) -> bool:
        """Return whether no direction is driven."""
        return bool(abs(theta[1]) <= theta[0])


class CoupledFriction(JointEffect):
    """
    Friction and inertia of a shaft that turns with the sum or difference of two joints.

    Wrists whose last gears share a shaft (Staubli: Gautier, J. Robotic Systems 14(2), 1997): dry
    friction acts on both joints, viscous friction and inertia of one on the other.

    """

    name = 'coupled_friction'
    family = 'friction'
    place = 'pair'
    group = 'coupled_friction'
    equation = ("tau_j += F_c sgn(q_j' +- q_k') + B q_k' + I q_k'', "
                "tau_k += +-F_c sgn(q_j' +- q_k') + B q_j' + I q_j''")
    coefficients: tuple[tuple[str, str], ...] = (
        ('F_c', 'N m'), ('B', 'N m s/rad'), ('I', 'kg m^2'))

    @classmethod
    def columns(cls, motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
        """Return the columns of both joints; see `JointEffect.columns`."""
        j, k, way = place
        v, a = motion.v, motion.a
        rubs = sign(v[:, j] + way * v[:, k], 0.5 * _SHARP * (motion.speed[j] + motion.speed[k]))
        return {j: np.stack([rubs, v[:, k], a[:, k]], axis=1),
                k: np.stack([way * rubs, v[:, j], a[:, j]], axis=1)}

    @classmethod
    def is_possible(cls, theta: Array) -> bool:
        """Return whether the shaft resists."""
        return bool(theta[0] >= 0.0)
