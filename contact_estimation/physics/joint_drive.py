# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Drives, gears and sensors of joints, and what is fixed to them."""

from typing import Any

import numpy as np

from .joint_effect import JointEffect, JointMotion, Place, positive
from .numeric import Array

_DEFLECTION = 0.03  # largest of a gear [rad]; of a series elastic drive twice that
_GAPS = (0.002, 0.007, 0.02, 0.035, 0.06)  # of worn gears [rad]
_ONE_SIDE = 0.02  # of the time
_LIGHT = 1e-6  # [kg m^2]: descriptions have links without inertia
_RESONANCE_HZ = 10.0  # the lowest of a drive that is built


def _powers(motion: JointMotion, j: Any, most: int) -> list[Array]:
    d = motion.q[:, j] - motion.middle[j]
    return [d, np.ones_like(d), *(d**k for k in range(2, most + 1))]


def _lagging(motion: JointMotion, j: int, shift: Array) -> dict[int, Array]:
    """Return what a lag of a joint's link adds to the torques of all joints."""
    change = motion.lagging(j, shift)
    return {k: change[:, k][:, None] for k in range(change.shape[1])}


def _gaps(motion: JointMotion, j: int) -> tuple[float, ...]:
    """Return gaps to compare; none where the load stays on one side, so that no gap shows."""
    positive_load = float(np.mean(motion.carried[:, j] > 0.0))
    return _GAPS if _ONE_SIDE < positive_load < 1.0 - _ONE_SIDE else ()


def through_gap(motion: JointMotion, j: int, gap: float) -> Array:
    """
    Return by how much a link lags behind its motor, which it leaves when the load changes side.

    Free between the ends of the gap, y'' = load / I_j, and without a rebound at them.
    """
    rates = (motion.carried[:, j] / np.maximum(motion.slopes[2][:, j, j], _LIGHT)).tolist()
    h, half = motion.period, 0.5 * gap
    y, speed, lag = half if rates[0] > 0.0 else -half, 0.0, []
    for rate in rates:
        speed += h * rate
        y += h * speed
        if abs(y) >= half:
            y, speed = half if y > 0.0 else -half, 0.0
        lag.append(y)
    return np.array(lag)


def _delayed(motion: JointMotion, place: Place, shape: float) -> dict[int, Array]:
    every = range(motion.load.shape[1]) if place is None else (place,)
    return {j: -motion.rate(motion.load[:, j])[:, None] for j in every}


def _delay(motion: JointMotion, place: Place) -> Array:
    return np.array([0.01])


def _compliance(motion: JointMotion, j: int) -> Array:
    return np.array([_DEFLECTION / (np.abs(motion.load[:, j]).max() + 1e-12)])


DRIVE = (
    JointEffect(
        'force_bias', 'sensor_zero', 'tau += bias', (('bias', 'N m'),),
        lambda motion, j, _: (np.ones(len(motion.q)),)),
    # Rotor and gears: every drive has them, and no robot description.
    JointEffect(
        'reflected_inertia', 'inertia', "tau += I_r q''", (('I_r', 'kg m^2'),),
        lambda motion, j, _: (motion.a[:, j],), possible=positive, laws=0),
    # Motor constant or gear ratio; published gains of one arm differ by 0.3.
    JointEffect(
        'force_gain', 'sensor_gain', 'tau += gain load', (('gain', '1'),),
        lambda motion, j, _: (motion.load[:, j],), typical=lambda motion, j: np.array([0.3])),
    # Torques are stamped later than positions, or earlier if negative.
    JointEffect(
        'force_delay', 'timing', 'tau(t) = load(t - delay)', (('delay', 's'),), _delayed,
        place='arm', typical=_delay),
    # That of one joint alone: a filter, or a bus on which drives are read in turn.
    JointEffect(
        'force_delay', 'timing', 'tau_j(t) = load_j(t - delay)', (('delay', 's'),), _delayed,
        typical=_delay),
    # A cable, a hose or a spring; slack where the torque is 0.
    JointEffect(
        'joint_spring', 'elastic_law', 'tau += K d + tau_m, d = q - q_m, q_m the mean position',
        (('K', 'N m/rad'), ('tau_m', 'N m')), lambda motion, j, _: _powers(motion, j, 1),
        possible=lambda theta: bool(theta[0] >= 0.0)),
    # A counterweight, or a spring or an accumulator across a joint.
    JointEffect(
        'counterbalance', 'elastic_law', 'tau += A sin(q) + B cos(q) + tau_0',
        (('A', 'N m'), ('B', 'N m'), ('tau_0', 'N m')), lambda motion, j, _: (
            np.sin(motion.q[:, j]), np.cos(motion.q[:, j]), np.ones(len(motion.q)))),
    JointEffect(
        'polynomial_stiffness', 'elastic_law',
        'tau += K d + tau_m + K_2 d^2 + K_3 d^3, d = q - q_m',
        (('K', 'N m/rad'), ('tau_m', 'N m'), ('K_2', 'N m/rad^2'), ('K_3', 'N m/rad^3')),
        is_curve=True, law=lambda motion, j, _: _powers(motion, j, 3)),
    # To first order in the compliance, the motor's inertia being `reflected_inertia`: Spong, J.
    # Dynamic Systems, Measurement, and Control 109(4), 1987.
    JointEffect(
        'joint_flexibility', 'inertia', 'tau = RNEA(q - compliance load_j)',
        (('compliance', 'rad/(N m)'),),
        lambda motion, j, _: _lagging(motion, j, motion.carried[:, j]), group='transmission',
        typical=_compliance, possible=positive),
    # The same joint measured behind its spring: the motor leads the link.
    JointEffect(
        'joint_flexibility', 'inertia', "tau += I_r (compliance load)''",
        (('I_r compliance', 's^2'),),
        lambda motion, j, _: (motion.rate(motion.rate(motion.carried[:, j])),),
        group='transmission', possible=positive,
        typical=lambda motion, j: np.array([(2.0 * np.pi * _RESONANCE_HZ) ** -2])),
    JointEffect(
        'backlash', 'clearance', "tau = RNEA(q - y), |y| <= gap / 2, y'' = load_j / M_jj between",
        (('gap', 'rad'),), lambda motion, j, gap: {k: column / gap for k, column in _lagging(
            motion, j, through_gap(motion, j, gap)).items()} if motion.period else {},
        group='transmission', typical=lambda motion, j: np.array([_GAPS[-1]]),
        possible=positive, shape=('simulated gap', 'rad'), shapes=_gaps),
)
