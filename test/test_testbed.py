# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The testbed: wall, impedance control, sensors."""

from __future__ import annotations

from dataclasses import replace

from contact_estimation.parameters.values import build
from contact_estimation.plant.open_loop import run_open_loop
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.reference.setpoints import Reference
from contact_estimation.reproduction.testbed_constants import (
    FlexibleWallConstants,
    TESTBED,
    TestbedConstants,
)
from contact_estimation.reproduction.testbed_runs import TRACKING_TARGET
from contact_estimation.reproduction.testbed_wall import moved, pressing_force, WallState
from contact_estimation.reproduction.testbed_world import TestbedWorld
import numpy as np
import pytest

WALL = FlexibleWallConstants()
IDEAL = replace(
    TESTBED,
    arm=replace(
        TESTBED.arm, rotor_inertias=(0.0, 0.0, 0.0), coulomb_frictions=(0.0, 0.0, 0.0),
        viscous_frictions=(0.0, 0.0, 0.0),
    ),
    wall=replace(WALL, static_friction=0.0, sliding_friction=0.0),
)


def press(constants: TestbedConstants, depth: float, duration: float) -> list[tuple[float, float]]:
    """Step x_r from the surface to a depth; return force and deflection of every sample."""
    world, seen = TestbedWorld(constants, TRACKING_TARGET, 0.0), []
    period = 1.0 / constants.sample_rate
    for _ in range(round(duration * constants.sample_rate)):
        truth = world.truth()
        seen.append((truth.force, truth.position))
        world.advance(period, Reference(depth, 0.0, 0.0, 0.0), truth.force)
    return seen


def test_ideal_arm_moves_as_the_plant_under_eq_1() -> None:
    # The controller acts sample by sample, which the plant's continuous impedance does not know.
    fast = replace(IDEAL, sample_rate=5000.0)
    truths, _ = run_open_loop(
        build(PlantParameters, {'sample_rate': 5000.0}), lambda t: (0.02, 0.0, 0.0, 0.0), 0.0, 0.5
    )
    force, deflection = np.array(press(fast, 0.02, 0.5)).T
    np.testing.assert_allclose(force, [truth.force for truth in truths], atol=0.1)
    np.testing.assert_allclose(deflection, [truth.position for truth in truths], atol=2e-5)


def test_slow_cycle_dissipates_twice_friction_times_stroke() -> None:
    state, work, rate, step, stroke = WallState(0.0, 0.0), 0.0, 1e-9, 1e-6, 2e-3
    for _ in range(2):  # the first settles the friction loop
        work = 0.0
        for sign in (1.0, -1.0):
            for _step in range(round(stroke / step)):
                state = moved(state, sign * step, WALL)
                work += sign * step * pressing_force(state, sign * rate, WALL)
    full_loop = 2.0 * WALL.static_friction * stroke
    # Presliding reduces the work at each reversal.
    assert work == pytest.approx(full_loop, rel=0.05)
    assert work < full_loop
