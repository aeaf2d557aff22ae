# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""References of the arms: three touches along the normal, and poses in free flight."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOVE_S = 1.0
_TOUCHES = ((0.016, 2.4), (0.022, 4.0), (0.028, 4.0))  # depth of x_r [m], duration [s]
_FREE_S = 3.0  # before the first touch
_APART = -0.012  # x_r between touches [m]
_FREQUENCIES = (0.7, 1.9, 4.3)  # of the excitation [Hz]
_AMPLITUDE = 0.003  # of each [m]
_POSE_S, _TURN_S = 1.2, 1.5


class Reference(NamedTuple):
    """Reference along one coordinate, or of all joints, on the grid of the simulation."""

    # x, v, a (N,) or (N, n): position [m] or [rad] and its derivatives
    x: Array
    v: Array
    a: Array


def touches(timestep: float, seed: int) -> Reference:
    """
    Return a reference with three touches of a wall at 0, excited by sines.

    timestep: of the grid [s]
    """
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, len(_FREQUENCIES))
    parts, here = [_held(_APART, _FREE_S, timestep)], _APART
    for depth, hold in _TOUCHES:
        parts += [_quintic(here, depth, MOVE_S, timestep),
                  _excited(depth, hold, phases, timestep),
                  _quintic(depth, _APART, MOVE_S, timestep), _held(_APART, 0.7, timestep)]
        here = _APART
    return Reference(*(np.concatenate(columns) for columns in zip(*parts)))


def poses(home: tuple[float, ...], count: int, timestep: float, seed: int) -> Reference:
    """
    Return a reference of the joints through random orientations of the wrist.

    home: joints at the beginning [rad]
    timestep: of the grid [s]
    Returns reference: of all joints, shape (N, n)
    """
    rng = np.random.default_rng(seed)
    here, parts = np.array(home), []
    for _ in range(count):
        there = np.array(home)
        there[-3:] += rng.uniform(-1.0, 1.0, 3) * (1.4, 1.3, 1.5)
        move, hold = _quintic(0.0, 1.0, _TURN_S, timestep), _held(1.0, _POSE_S, timestep)
        share = [np.concatenate(columns)[:, None] for columns in zip(move, hold)]
        parts.append(Reference(here + share[0] * (there - here), share[1] * (there - here),
                               share[2] * (there - here)))
        here = there
    return Reference(*(np.concatenate(columns) for columns in zip(*parts)))


def _held(x: float, duration: float, timestep: float) -> Reference:
    t = np.zeros(round(duration / timestep))
    return Reference(t + x, t, t)


def _quintic(begin: float, end: float, duration: float, timestep: float) -> Reference:
    """Return a minimum-jerk move."""
    s: Array = np.linspace(0.0, 1.0, round(duration / timestep), endpoint=False)
    step = end - begin
    return Reference(
        begin + step * s**3 * (10 - 15 * s + 6 * s**2),
        step / duration * 30 * s**2 * (1 - s)**2,
        step / duration**2 * 60 * s * (1 - s) * (1 - 2 * s),
    )


def _excited(depth: float, duration: float, phases: Array, timestep: float) -> Reference:
    """Return sines about a depth, faded in and out over half a second."""
    t = np.asarray(np.arange(round(duration / timestep)) * timestep, float)
    ramp = np.clip(np.minimum(t, duration - t) / 0.5, 0.0, 1.0)
    window = ramp**3 * (10 - 15 * ramp + 6 * ramp**2)
    omega = 2 * np.pi * np.array(_FREQUENCIES)[:, None]
    x: Array = depth + _AMPLITUDE * window * np.sin(omega * t + phases[:, None]).sum(axis=0)
    v: Array = np.gradient(x, timestep, edge_order=2)
    a: Array = np.gradient(v, timestep, edge_order=2)
    return Reference(x, v, a)
