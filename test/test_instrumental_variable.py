# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Instrumental variables, and the compliance and target of a robot."""

from __future__ import annotations

from math import nan
from typing import Any

from contact_estimation.estimators.instrumental_variable import (
    InstrumentalVariable, InstrumentalVariableParameters)
from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.pipeline.arm_outputs import step_along
from contact_estimation.reference.parameters import PoseLimits
from core_runs import contact_samples, estimates_of, pipeline_with
from core_steps import known, learn
import numpy as np
from numpy.typing import NDArray
import pytest

K, B, T, LAG = 4800.0, 200.0, 0.002, 10
POSITION_NOISE = 1e-4


def estimator(**tuning: Any) -> InstrumentalVariable:
    """Make an estimator with the default first guess."""
    return InstrumentalVariable(
        InstrumentalVariableParameters(**tuning), EnvironmentParameters(), T
    )


def rows_of(count: int, noise: float = 0.5, seed: int = 10) -> NDArray[np.float64]:
    """Rows (y, d, v, 1, 0) of a sine contact."""
    t = T * np.arange(count)
    d, v = 0.01 + 0.002 * np.sin(20.0 * t), 0.04 * np.cos(20.0 * t)
    errors = noise * np.random.default_rng(seed).standard_normal(count)
    return np.column_stack([K * d + B * v + errors, d, v, np.ones(count), np.zeros(count)])


@pytest.mark.parametrize('name, low, high', [
    ('instrumental_variable', -1.5, 1.5), ('rls', -30.0, -4.0), ('kalman', -30.0, -4.0),
    ('indirect_adaptive', -30.0, -4.0)])
def test_position_noise_biases_the_damping_of_all_others(
    name: str, low: float, high: float
) -> None:
    for seed in range(2):
        samples = contact_samples(4.0, K, B, force_noise=0.58, position_noise=POSITION_NOISE,
                                  with_velocity=False, seed=seed)
        pipeline = pipeline_with(estimator=name, contact__position_noise=POSITION_NOISE)
        assert low < 100.0 * (estimates_of(samples, pipeline)[-1].damping / B - 1.0) < high


def test_recursion_equals_the_batch_solution() -> None:
    rows, keep = rows_of(400), np.exp(-T / 0.5)
    of = estimator(memory_s=0.5, delay_s=LAG * T, stiffness_std=1e9, damping_std=1e9)
    for row in rows.tolist():
        learn(of, T, row, 0.25)
    phi, y, z = rows[LAG:, 1:3], rows[LAG:, 0], rows[:-LAG, 1:3]
    weights = keep ** np.arange(len(y) - 1, -1, -1.0)
    A = (z * weights[:, None]).T @ phi
    theta = np.linalg.solve(A, (z * weights[:, None]).T @ y)
    np.testing.assert_allclose([of.stiffness, of.damping], theta, rtol=1e-9)
    spread = np.linalg.inv(A) @ ((z * weights[:, None] ** 2).T @ z) @ np.linalg.inv(A).T
    np.testing.assert_allclose(known(of)[2:4], 0.5 * np.sqrt(np.diag(spread)), rtol=1e-9)


C = 2e-5


@pytest.mark.parametrize('K_e', [5e3, 3e4])
def test_the_estimate_is_that_of_the_wall_behind_a_compliant_robot(K_e: float) -> None:
    samples = [
        s._replace(position=s.position - C * s.force, velocity=float('nan'))
        for s in contact_samples(2.0, K_e=K_e, B_e=K_e * 2e-3, depth=50.0 / K_e,
                                 amplitude=10.0 / K_e)
    ]
    plain, known = (
        estimates_of(samples, pipeline_with(
            estimator='rls_adaptive', contact__force_noise=1e-3, robot__compliance=compliance))[-1]
        for compliance in (0.0, C)
    )
    assert plain.stiffness == pytest.approx(K_e / (1.0 + C * K_e), rel=3e-3)
    assert known.stiffness == pytest.approx(K_e, rel=3e-3)
    assert known.damping == pytest.approx(K_e * 2e-3, rel=0.1)


DOWN = (0.0, 0.0, -1.0)
BOX = PoseLimits(lead=0.05, lower=(-1.0, -1.0, 0.1), upper=(1.0, 1.0, 0.5))


@pytest.mark.parametrize('position, step, expected', [
    ((0.0, 0.0, 0.3), 0.02, 0.02),
    ((0.0, 0.0, 0.3), 0.20, 0.05),  # the lead
    ((0.0, 0.0, 0.3), -0.20, -0.05),
    ((0.0, 0.0, 0.12), 0.04, 0.02),  # the floor of the box
    ((0.0, 0.0, 0.08), 0.04, -0.02),  # back into it
    ((0.0, 0.0, 0.0), 0.04, None),  # further out than the lead
    ((0.0, 1.5, 0.3), 0.01, None),  # beside it
    ((0.0, 0.0, 0.3), nan, None),
])
def test_steps_stay_within_lead_and_box(
    position: tuple[float, ...], step: float, expected: float | None
) -> None:
    assert step_along(position, DOWN, step, BOX) == (
        None if expected is None else pytest.approx(expected))


def test_an_empty_box_is_refused() -> None:
    with pytest.raises(ParameterRangeError, match=r'lower must be <= .*got \[0.0, 0.0, 2.0'):
        PoseLimits(lower=(0.0, 0.0, 2.0), upper=(1.0, 1.0, 1.0))
