# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Eq. (6) against forms written in another way."""

from __future__ import annotations

from math import hypot, tanh
from typing import Any

from contact_estimation.estimators.contact_points import (
    contact_forces,
    ContactGeometry,
    point_motions,
    ToolMotion,
    total_wrench,
)
from contact_estimation.exceptions import SignalShapeError
from contact_estimation.reproduction.three_contacts_world import GEOMETRY, motion_at
import numpy as np
import pytest

K_E, B_E, MU = 4800.0, 200.0, 0.3
INSTANTS = (1.3, 2.55, 3.7, 4.55, 5.9, 7.5, 8.65, 8.75)  # of the example: all that can happen


def force_of(geometry: ContactGeometry, motion: ToolMotion, mu: float = MU) -> np.ndarray:
    """Compute the force of eq. (6)."""
    points = point_motions(geometry, motion)
    return total_wrench(points.arms, contact_forces(geometry, points, K_E, B_E, mu))[0]


def scalar_force(t: float) -> list[float]:
    """Write eq. (6) for the example out point by point, axis by axis, without vectors."""
    motion = motion_at(t)
    (x, _, z), (vx, vy, vz), w = motion.position, motion.velocity, motion.angular_velocity[1]
    c, s = motion.rotation[0, 0], motion.rotation[0, 2]
    total = [0.0, 0.0, 0.0]
    for px, pz, normal_axis in ((0.03, -0.04, 2), (-0.03, -0.04, 2), (0.05, 0.01, 0)):
        rx, rz = c * px + s * pz, -s * px + c * pz
        ux, uz = vx + w * rz, vz - w * rx  # of the point: the tool turns about y alone
        if normal_axis == 2:
            depth, rate, slide = -(z + rz), -uz, {0: ux, 1: vy}
        else:
            depth, rate, slide = x + rx - 0.15, ux, {1: vy, 2: uz}
        F_n = max(0.0, K_E * depth + B_E * rate) if depth > 0.0 else 0.0
        total[normal_axis] += F_n if normal_axis == 2 else -F_n
        speed = hypot(*slide.values())
        for axis, part in slide.items():
            total[axis] -= MU * F_n * tanh(speed / 4e-4) * (part / speed if speed else 0.0)
    return total


@pytest.mark.parametrize('t', INSTANTS)
def test_force_equals_eq_6_written_out_in_scalars(t: float) -> None:
    force = force_of(GEOMETRY, motion_at(t))
    assert force.tolist() == pytest.approx(scalar_force(t), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize('t', INSTANTS)
def test_wrench_has_the_power_of_the_forces_at_the_points(t: float) -> None:
    motion = motion_at(t)
    points = point_motions(GEOMETRY, motion)
    forces = contact_forces(GEOMETRY, points, K_E, B_E, MU)
    force, torque = total_wrench(points.arms, forces)
    whole = force @ motion.velocity + torque @ motion.angular_velocity
    at_points = sum(
        -F @ n * rate + F @ slip
        for F, n, rate, slip in zip(forces, GEOMETRY.normals, points.delta_dot, points.slip)
    )
    assert whole == pytest.approx(at_points, rel=1e-9, abs=1e-12)


def geometry_with(**changed: Any) -> ContactGeometry:
    """Make a valid geometry but for what is changed."""
    flat = {'points': np.zeros((2, 3)), 'surfaces': np.zeros((2, 3)),
            'normals': np.array([[0.0, 0.0, 1.0]] * 2)}
    return ContactGeometry(**{**flat, **changed})


def test_arrays_of_different_shape_are_refused_by_name() -> None:
    with pytest.raises(SignalShapeError, match=r'normals must have a row .* got \(3, 3\)'):
        geometry_with(normals=np.eye(3))
    with pytest.raises(SignalShapeError, match=r'points must have a row .* got \(3,\)'):
        geometry_with(points=np.zeros(3))
