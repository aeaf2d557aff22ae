# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Motions of an arm that press on a wall, along a Cartesian path."""

from __future__ import annotations

import numpy as np

from .arm_excitation import ArmTrajectory, Array
from ..kinematics.arm_dynamics import ArmDynamics

_PERIOD_S, _RAMP_S, _FREE_S = 6.0, 1.0, 1.5
_TONES, _LOWEST_HZ, _HIGHEST_HZ = 6, 0.4, 4.0
_ASIDE_M, _ASIDE_HZ = 0.06, 0.17
_DAMPED = 1e-3  # singular values left out, in the largest


def pressing_motion(
    arm: ArmDynamics, frame: str, q: Array, normal: Array, rng: np.random.Generator,
    depth: float = 0.05, excitation: float = 0.012, duration: float = 24.0, rate: float = 200.0,
) -> ArmTrajectory:
    """
    Return a motion that presses several times, with tones, and moves aside along the wall.

    arm: with n joints
    frame: link that presses; it does not turn
    q (n,): where it begins
    normal (3,): unit vector into the wall
    rng: of the tones
    depth, excitation: how far the path goes beyond its begin, and the size of the tones [m]
    duration, rate: [s], [Hz]
    """
    t = np.arange(0.0, duration, 1.0 / rate)
    within = t % _PERIOD_S
    s = np.clip(np.minimum((within - _FREE_S) / _RAMP_S, (_PERIOD_S - within) / _RAMP_S), 0.0, 1.0)
    pressing = s * s * (3.0 - 2.0 * s)
    tones, phases = rng.uniform(_LOWEST_HZ, _HIGHEST_HZ, _TONES), rng.uniform(0.0, 6.0, _TONES)
    wave = np.sum([np.sin(2.0 * np.pi * f * t + phase) / np.sqrt(f)
                   for f, phase in zip(tones, phases)], axis=0)
    aside = np.eye(3)[int(np.argmin(np.abs(normal)))]
    path = np.outer(pressing * (depth + excitation * wave / np.abs(wave).max()), normal)
    path += np.outer(_ASIDE_M * np.sin(2.0 * np.pi * _ASIDE_HZ * t), aside)
    followed = [np.asarray(q, float)]
    for step in np.diff(path, axis=0):
        here = followed[-1]
        twist = np.concatenate([arm.pose(here, frame)[0].T @ step, np.zeros(3)])
        followed.append(here + np.linalg.pinv(arm.jacobian(here[None], frame)[0], _DAMPED) @ twist)
    v = np.gradient(np.array(followed), t, axis=0)
    return ArmTrajectory(t, np.array(followed), v, np.gradient(v, t, axis=0), np.nan)
