# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The testbed: wall, impedance control, sensors."""

from __future__ import annotations

from dataclasses import replace
from math import isnan

from contact_estimation.estimators.offline_estimator import TargetImpedance
from contact_estimation.parameters.values import build
from contact_estimation.plant.plant_parameters import PlantParameters
from contact_estimation.plant.simulation import run_open_loop
from contact_estimation.reference.setpoints import Reference
from contact_estimation.studies.reproduction.testbed_constants import (
    FlexibleWallConstants,
    TESTBED,
    TestbedConstants,
)
from contact_estimation.studies.reproduction.testbed_runs import identify_arm, TRACKING_TARGET
from contact_estimation.studies.reproduction.testbed_world import (
    free_rate, make_sensors, moved, PaperAcquisition, pressing_force, RawAcquisition, TestbedWorld,
    WallState)
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


def test_real_impedance_differs_from_the_target() -> None:
    target = TargetImpedance()
    arm = identify_arm(target, 0)
    assert arm.mass > 1.3 * target.mass
    assert arm.damping > target.damping


def test_identified_impedance_of_an_ideal_arm_is_the_target(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr('contact_estimation.studies.reproduction.testbed_runs.TESTBED', IDEAL)
    arm = identify_arm(TargetImpedance(), 0)
    assert (arm.mass, arm.damping) == pytest.approx((20.0, 50.0), rel=0.06)


def test_wall_stays_where_friction_holds_the_push() -> None:
    # x_r so shallow that the arm pushes with less than 6 N
    force, deflection = press(TESTBED, 0.9 * WALL.static_friction / 5000.0, 1.0)[-1]
    assert -force < WALL.static_friction
    assert 0.0 < deflection < 5.0 * WALL.presliding


def test_wall_yields_beyond_the_static_friction() -> None:
    assert press(TESTBED, 3.0 * WALL.static_friction / 5000.0, 1.0)[-1][1] > 20.0 * WALL.presliding


def test_friction_depends_on_the_distance_and_not_on_the_step_size() -> None:
    once = moved(WallState(0.0, -0.4), 3e-5, WALL)
    often = WallState(0.0, -0.4)
    for _ in range(30):
        often = moved(often, 1e-6, WALL)
    assert often == pytest.approx(once, rel=1e-9)


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


def test_released_wall_moves_without_contact_force() -> None:
    state = WallState(5e-3, -1.0)
    rate = free_rate(state, WALL)
    assert pressing_force(state, rate, WALL) == pytest.approx(0.0, abs=1e-9)
    assert rate < 0.0


def test_wall_never_pulls() -> None:
    world = TestbedWorld(TESTBED, TRACKING_TARGET, 0.0)
    forces = []
    for k in range(1000):
        truth = world.truth()
        forces.append(truth.force)
        world.advance(0.002, Reference(0.02 if k < 400 else -0.1, 0, 0, 0), truth.force)
    assert max(forces) <= 0.0
    assert forces[-1] == 0.0
    assert min(forces) < -40.0


def test_wall_rests_within_the_range_that_friction_holds() -> None:
    world = TestbedWorld(TESTBED, TRACKING_TARGET, 0.0)
    for k in range(1500):
        world.advance(0.002, Reference(0.02 if k < 400 else -0.1, 0, 0, 0), 0.0)
    held = WALL.static_friction / WALL.stiffness
    assert 0.0 < world.truth().position <= held
    assert world.truth().velocity == pytest.approx(0.0, abs=1e-4)


def test_paper_s_processing_subtracts_the_static_friction() -> None:
    acquisition = PaperAcquisition(TESTBED)
    for _ in range(200):
        force, position, velocity = acquisition.process(-40.0, 0.008)
    assert (force, position, velocity) == pytest.approx((-34.0, 0.008, 0.0), abs=1e-6)


def test_paper_s_processing_gives_the_velocity_of_the_wall() -> None:
    acquisition, T = PaperAcquisition(TESTBED), 1.0 / TESTBED.sample_rate
    for k in range(200):
        velocity = acquisition.process(-40.0, 0.03 * k * T)[2]
    assert velocity == pytest.approx(0.03, rel=1e-6)


def test_paper_s_processing_gives_no_force_in_free_flight() -> None:
    acquisition = PaperAcquisition(TESTBED)
    assert {acquisition.process(f, 0.0)[0] for f in (0.9, -0.9, 0.3)} == {0.0}


def test_raw_samples_have_no_velocity() -> None:
    force, position, velocity = RawAcquisition().process(-3.0, 0.001)
    assert (force, position) == (-3.0, 0.001)
    assert isnan(velocity)


def test_potentiometer_is_quantised_and_noise_follows_the_seed() -> None:
    truth = TestbedWorld(TESTBED, TRACKING_TARGET, 0.0).truth()
    sensors, twin, other = (make_sensors(TESTBED, seed) for seed in (1, 1, 2))
    read = [sensors.measure(truth) for _ in range(100)]
    steps = np.array([position for _, position, _ in read]) / TESTBED.sensing.potentiometer_step
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
    assert max(abs(force) for force, _, _ in read) <= TESTBED.sensing.force_noise
    assert [r[:2] for r in read] == [twin.measure(truth)[:2] for _ in range(100)]
    assert read[0][:2] != other.measure(truth)[:2]
