# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Simulation of a tool that touches a floor with two points and a wall with a third."""

from __future__ import annotations

from math import cos, pi, sin
from typing import NamedTuple

import numpy as np

from ...estimators.contact_points import (
    Array, contact_forces, ContactGeometry, point_motions, ToolMotion, total_wrench)
from ...estimators.contact_points_estimator import ContactPointsSample
from ...reference.reference_generator import quintic

K_E, B_E, MU = 4800.0, 200.0, 0.3
RATE = 500.0
DURATION = 10.0
POINTS = ('front foot', 'rear foot', 'nose')
GEOMETRY = ContactGeometry(
    points=np.array([[0.03, 0.0, -0.04], [-0.03, 0.0, -0.04], [0.05, 0.0, 0.01]]),
    surfaces=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.15, 0.0, 0.0]]),
    normals=np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]),
)

FORCE_NOISE = 1.0  # +- [N], uniform, as the paper's
POSITION_NOISE, VELOCITY_NOISE = 1e-5, 1e-4  # standard deviations [m], [m/s]

_START = (0.0, 0.0, 0.055)
_PITCH = 0.12  # [rad]: the front foot touches first
# (axis, begin [s], duration [s], way [m or rad]); axis 3 is the pitch
_MOVES = (
    (2, 0.4, 1.2, -0.0165),  # down: the front foot touches
    (3, 2.2, 0.8, -_PITCH),  # level: the rear foot touches too
    (0, 3.2, 1.6, 0.106),  # slide along the floor until the nose touches the wall
    (1, 5.2, 1.6, 0.08),  # slide along both
    (0, 7.4, 0.6, -0.04),  # away from the wall
    (2, 8.6, 0.8, 0.04),  # up
)
# (axis, begin, end [s], amplitude [m], angular frequency [rad/s]): begins and ends at rest
_SWINGS = (
    (2, 1.7, 1.7 + 4.0 * pi / 10.0, 1e-3, 20.0),
    (2, 3.0, 3.0 + 18.0 * pi / 10.0, 1e-3, 20.0),
    (0, 5.0, 5.0 + 16.0 * pi / 23.0, 1e-3, 23.0),
)


class Instant(NamedTuple):
    """One instant of the simulation."""

    t: float  # time [s]
    sample: ContactPointsSample  # measured force and motion
    delta: Array  # (3,) True penetrations [m]
    forces: Array  # (3, 3) True force at each point [N]


def motion_at(t: float) -> ToolMotion:
    """
    Return the prescribed pose and twist of the tool.

    t: time [s]
    """
    place, rate = [*_START, _PITCH], [0.0] * 4
    for axis, begin, duration, way in _MOVES:
        x, v, _ = quintic(0.0, way, duration, t - begin)
        place[axis] += x
        rate[axis] += v
    for axis, begin, end, amplitude, omega in _SWINGS:
        if begin < t < end:
            phase = omega * (t - begin)
            place[axis] += amplitude * (1.0 - cos(phase)) * (1.0 if axis == 0 else -1.0)
            rate[axis] += amplitude * omega * sin(phase) * (1.0 if axis == 0 else -1.0)
    c, s = cos(place[3]), sin(place[3])
    rotation = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return ToolMotion(
        np.array(place[:3]), rotation, np.array(rate[:3]), np.array([0.0, rate[3], 0.0])
    )


def simulate(seed: int = 0) -> list[Instant]:
    """Simulate the measurements of force sensor and robot."""
    noise = np.random.default_rng(seed)
    return [_instant(k, noise) for k in range(round(DURATION * RATE))]


def _instant(k: int, noise: np.random.Generator) -> Instant:
    motion = motion_at(k / RATE)
    points = point_motions(GEOMETRY, motion)
    forces = contact_forces(GEOMETRY, points, K_E, B_E, MU)
    force, _ = total_wrench(points.arms, forces)
    measured = motion._replace(
        position=motion.position + noise.normal(0.0, POSITION_NOISE, 3),
        velocity=motion.velocity + noise.normal(0.0, VELOCITY_NOISE, 3),
    )
    felt = force + noise.uniform(-FORCE_NOISE, FORCE_NOISE, 3)
    sample = ContactPointsSample(round(k * 1e9 / RATE), felt, measured)
    return Instant(k / RATE, sample, points.delta, forces)
