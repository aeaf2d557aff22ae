# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The arm of the testbed: equations against independent forms."""

from __future__ import annotations

from dataclasses import replace

from contact_estimation.reproduction.testbed_arm import PlanarArm
from contact_estimation.reproduction.testbed_constants import ArmConstants, Triple
import numpy as np
from numpy.typing import NDArray
import pytest

ANGLES: Triple = (1.2, -0.5, 0.3)
RATES: Triple = (0.4, -1.1, 0.7)
FRICTIONLESS = replace(
    ArmConstants(), coulomb_frictions=(0.0, 0.0, 0.0), viscous_frictions=(0.0, 0.0, 0.0)
)


def full(arm: PlanarArm, angles: Triple) -> NDArray[np.float64]:
    """Return the full mass matrix."""
    m11, m12, m13, m22, m23, m33 = arm.mass_matrix(angles)
    return np.array([[m11, m12, m13], [m12, m22, m23], [m13, m23, m33]])


def kinetic_energy(p: ArmConstants, angles: Triple, rates: Triple) -> float:
    """Sum the energies of links and rotors from the velocity of each centre of mass."""
    energy = last = 0.0
    joint: NDArray[np.float64] = np.zeros(2)
    for i in range(3):
        across = np.array([-np.sin(angles[i]), np.cos(angles[i])]) * rates[i]
        centre = joint + p.centres[i] * across
        energy += 0.5 * (p.masses[i] * float(centre @ centre) + p.inertias[i] * rates[i] ** 2)
        energy += 0.5 * p.rotor_inertias[i] * (rates[i] - last) ** 2
        joint, last = joint + p.lengths[i] * across, rates[i]
    return energy


def test_mass_matrix_gives_the_kinetic_energy_of_the_bodies() -> None:
    rates = np.array(RATES)
    energy = 0.5 * rates @ full(PlanarArm(ArmConstants()), ANGLES) @ rates
    assert energy == pytest.approx(kinetic_energy(ArmConstants(), ANGLES, RATES), rel=1e-12)


def test_energy_is_conserved_without_friction_and_torque() -> None:
    arm, h = PlanarArm(FRICTIONLESS), 1e-3

    def slope(state: NDArray[np.float64]) -> NDArray[np.float64]:
        angles, rates = tuple(state[:3].tolist()), tuple(state[3:].tolist())
        return np.array([*rates, *arm.accelerations(angles, rates, (0.0, 0.0, 0.0), 0.0)])

    state = np.array([*ANGLES, *(3.0 * np.array(RATES))])
    begin = kinetic_energy(FRICTIONLESS, ANGLES, tuple(state[3:].tolist()))
    for _ in range(2000):
        k1 = slope(state)
        k2 = slope(state + 0.5 * h * k1)
        k3 = slope(state + 0.5 * h * k2)
        state = state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + slope(state + h * k3))
    end = kinetic_energy(FRICTIONLESS, tuple(state[:3].tolist()), tuple(state[3:].tolist()))
    assert end == pytest.approx(begin, rel=1e-7)


def test_inverse_kinematics_invert_the_direct_ones() -> None:
    p = ArmConstants()
    arm = PlanarArm(p)
    for x in (p.surface_x - 0.1, p.surface_x, p.surface_x + 0.03):
        tip = arm.tip(arm.angles_at(x, p.tip_y, p.tip_angle), RATES)
        assert (tip.x, tip.y, tip.angle) == pytest.approx((x, p.tip_y, p.tip_angle), abs=1e-12)
        assert arm.tip_x(arm.angles_at(x, p.tip_y, p.tip_angle)) == pytest.approx(x)
