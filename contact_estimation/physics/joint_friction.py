# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Friction of joints: the laws of the library at the velocity of a joint."""

from typing import Any, Callable

import numpy as np

from .asymmetric_damping import AsymmetricDamping
from .coulomb_friction import CoulombFriction
from .joint_effect import JointEffect, JointMotion, Place, positive
from .numeric import Array, SIGN_VELOCITY
from .presliding_friction import PreslidingFriction
from .quadratic_damping import QuadraticDamping

_SHARP = 0.02  # of the speed of a joint: width of its sgn where a law has another shape
_TRAVELS = (0.001, 0.003, 0.01, 0.03)  # over which dry friction of gears reverses [rad]


def _law(effect: Any, v: Array, per_speed: Any = 1.0) -> Array:
    """Return the resistance of a law of the library at velocities in another unit."""
    return np.asarray(effect.resistance(0.0, 0.0 * v, v * per_speed, (), np))


def sign(v: Array, width: Any) -> Array:
    """Return tanh(v / width), the sgn(v) of the library in the unit of a joint."""
    return _law(CoulombFriction(1.0), v, SIGN_VELOCITY / width)


def _of_speed(*shares: float) -> Callable[[JointMotion, Place], tuple[float, ...]]:
    """Return shapes that are shares of the speed of a joint."""
    return lambda motion, place: tuple(float(share * motion.speed[place]) for share in shares)


def _reversing(motion: JointMotion, j: int, travel: float) -> Array:
    """Return Dahl's z for F_c = 1, driven by the position; sgn(q') at a single instant."""
    if not motion.period:
        return sign(motion.v[:, j], _SHARP * motion.speed[j])
    law = PreslidingFriction(F_c=1.0, sigma=1.0 / travel)
    t = motion.period * np.arange(len(motion.q), dtype=float)
    return law.states_along(t, motion.q[:, j], motion.v[:, j], np.ones(len(t), bool))[1]


def _stribeck(motion: JointMotion, j: int, v_s: float) -> tuple[Array, Array]:
    """Return the law for F_c = 1 and for F_s = 1 alone."""
    rubs, drop = _reversing(motion, j, _TRAVELS[0]), np.exp(-(motion.v[:, j] / v_s) ** 2)
    return rubs * (1.0 - drop), rubs * drop


def _load_dependent(motion: JointMotion, j: int, travel: float) -> tuple[Array, Array]:
    rubs = _reversing(motion, j, travel)
    return rubs, np.abs(motion.load[:, j]) * rubs


def _coupled(motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
    """Return dry friction of the sum of two joints; friction and inertia of one on the other."""
    j, k, way = place
    v, a = motion.v, motion.a
    rubs = sign(v[:, j] + way * v[:, k], 0.5 * _SHARP * (motion.speed[j] + motion.speed[k]))
    return {j: np.stack([rubs, way * v[:, k], way * a[:, k]], axis=1),
            k: way * np.stack([rubs, v[:, j], a[:, j]], axis=1)}


# Every joint has plain friction: no law that is surprising, nor is its place.
_DRY: dict[str, Any] = {'family': 'friction', 'group': 'dry_friction', 'possible': positive,
                        'laws': 0}
_VISCOUS: dict[str, Any] = {'family': 'friction', 'group': 'viscous_friction', 'laws': 0}
_B = ('B', 'N m s/rad')
_QUADRATIC = QuadraticDamping(B_2=1.0)
_ASYMMETRIC = AsymmetricDamping(B_a=1.0)

FRICTION = (
    # The width: lubricated gears creep.
    JointEffect(
        'coulomb_friction', equation="tau += F_c tanh(q' / width)",
        coefficients=(('F_c', 'N m'),), shape=('width', 'rad/s'),
        shapes=_of_speed(_SHARP, 0.1, 0.3),
        law=lambda motion, j, width: (sign(motion.v[:, j], width),), **_DRY),
    JointEffect(
        'stribeck_friction', equation="tau += (F_c + (F_s - F_c) exp(-(q' / v_s)^2)) sgn(q')",
        coefficients=(('F_c', 'N m'), ('F_s', 'N m')), shape=('v_s', 'rad/s'),
        shapes=_of_speed(0.1, 0.2, 0.4), law=_stribeck,
        **{**_DRY, 'laws': 1, 'possible': lambda theta: bool(0.0 <= theta[0] <= theta[1])}),
    JointEffect(
        'presliding_friction', equation="tau += z, z' = (q' / travel) (F_c - z sgn q')",
        coefficients=(('F_c', 'N m'),), shape=('travel', 'rad'),
        shapes=lambda motion, j: _TRAVELS,
        law=lambda motion, j, travel: (_reversing(motion, j, travel),), **_DRY),
    # Teeth rub in proportion to what they carry: Hamon, Gautier, Garrec and Janot, IROS 2010.
    JointEffect(
        'load_dependent_friction', equation='tau += (F_c + mu |load|) z / F_c',
        coefficients=(('F_c', 'N m'), ('mu', '1')), shape=('travel', 'rad'),
        shapes=lambda motion, j: _TRAVELS, law=_load_dependent, **{**_DRY, 'laws': 1}),
    JointEffect(
        'viscous_friction', equation="tau += B q'", coefficients=(_B,), possible=positive,
        law=lambda motion, j, _: (motion.v[:, j],), **_VISCOUS),
    # B_2 < 0: a lubricant that thins with the rate of shear.
    JointEffect(
        'quadratic_damping', equation="tau += B q' + B_2 q' |q'|",
        coefficients=(_B, ('B_2', 'N m s^2/rad^2')), possible=lambda theta: bool(theta[0] >= 0.0),
        law=lambda motion, j, _: (motion.v[:, j], _law(_QUADRATIC, motion.v[:, j])),
        **{**_VISCOUS, 'laws': 1}),
    JointEffect(
        'asymmetric_damping', equation="tau += B q' + B_a |q'|",
        coefficients=(_B, ('B_a', 'N m s/rad')),
        possible=lambda theta: bool(abs(theta[1]) <= theta[0]),
        law=lambda motion, j, _: (motion.v[:, j], _law(_ASYMMETRIC, motion.v[:, j])),
        **{**_VISCOUS, 'laws': 1}),
    # Wrists whose last gears share a shaft: Gautier, J. Robotic Systems 14(2), 1997.
    JointEffect(
        'coupled_friction', 'friction',
        "tau_j += F_c sgn(q_j' +- q_k') +- B q_k' +- I q_k'', "
        "tau_k += +-(F_c sgn(q_j' +- q_k') + B q_j' + I q_j'')",
        (('F_c', 'N m'), _B, ('I', 'kg m^2')), _coupled, place='pair', group='coupled_friction',
        possible=lambda theta: positive(theta[:2])),
)
