# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""The motion of a link behind a flexible joint, against that of the plant."""

from concealed_worlds import physics, prepared_from, recorded
from contact_estimation.diagnosis.observe.link import (
    link_against_wall,
    link_motion,
    run_jointed,
)
from contact_estimation.diagnosis.observe.residuals import force_residual, residuals
from contact_estimation.physics.contact_law import ContactLaw
from contact_estimation.physics.robot_law import RobotLaw
from effect_examples import example
import numpy as np
import pytest
from world_reference import B_e, B_t, K_e, K_t, M_t, reference_at, simulate, with_effect

H = 2e-4
TRUTHS = simulate(9000, with_effect('joint_flexibility', sample_rate=1.0 / H))
T, X, V, LINK_A, FORCE, _ = np.array(TRUTHS).T
A = np.gradient(V, H)
ROBOT = RobotLaw(M_t, B_t, K_t, [example('joint_flexibility')])
WALL = ContactLaw(K_e, B_e, 0.0, 0.0, True, [])


def test_link_under_the_true_force_moves_as_in_the_plant() -> None:
    assert ROBOT.joint is not None and np.min(FORCE) < -20.0
    y, w, a = link_motion(ROBOT.joint, X, V, A, FORCE, H)
    assert np.sqrt(np.mean((WALL.force(T, X, V, a) - FORCE) ** 2)) > 1.0
    assert np.sqrt(np.mean((WALL.force(T, y, w, a) - FORCE) ** 2)) < 0.02
    inside = (np.abs(T - 0.9) < 0.05) & (FORCE < -1.0)
    np.testing.assert_allclose(a[inside], LINK_A[inside], atol=0.02)


def test_link_against_the_wall_does_not_follow_the_noise_of_the_force() -> None:
    assert ROBOT.joint is not None
    noisy = FORCE + np.random.default_rng(1).standard_normal(len(FORCE))
    y, w, a = link_motion(ROBOT.joint, X, V, A, noisy, H)
    following = np.sqrt(np.mean((WALL.force(T, y, w, a) - FORCE) ** 2))
    motion = link_against_wall(ROBOT.joint, WALL, T, X, V, A, noisy)
    assert np.sqrt(np.mean((WALL.force(T, *motion) - FORCE) ** 2)) < 0.1 * following


def test_motor_moves_under_reference_and_force_as_in_the_plant() -> None:
    push = ROBOT.impedance_force(0.0, 0.0, np.array([reference_at(t) for t in T.tolist()]).T)
    moved = run_jointed(ROBOT, push, FORCE, float(X[0]), H)
    np.testing.assert_allclose(moved, X, atol=5e-6)  # the command begins between two samples
    rigid = run_jointed(
        RobotLaw(M_t, B_t, K_t, [example('joint_flexibility', (1e-7, 0.2, 0.1))]),
        push, FORCE, float(X[0]), H)
    assert np.max(np.abs(rigid - X)) > 1e-4


def test_a_joint_vanishes_in_proportion_to_its_compliance() -> None:
    recording, model = prepared_from(recorded())
    rigid = residuals(recording, model, robust=False)

    def change(compliance: float) -> float:
        jointed = model.with_effect('joint_flexibility', (compliance, 0.2, 0.3))
        return float(np.std(residuals(recording, jointed, robust=False) - rigid))

    assert 0.1 < change(1e-6) < 10.0
    assert change(1e-8) == pytest.approx(0.01 * change(1e-6), rel=0.1)


def test_tool_before_the_wall_is_accelerated_with_the_link() -> None:
    noise = 0.01
    recording, model = prepared_from(recorded(
        seed=2, sensors__force_noise=noise, **physics('joint_flexibility', 4e-5, 0.2, 0.2),
        **physics('tool_inertia', 1.0)))
    jointed = model.with_effect('joint_flexibility', (4e-5, 0.2, 0.2))

    def error(mass: float) -> float:
        return float(np.std(force_residual(
            recording, jointed.with_effect('tool_inertia', (mass,)))))

    assert error(1.0) < 10.0 * noise  # 50 with the acceleration of the motor
    assert error(0.0) > 100.0 * noise
