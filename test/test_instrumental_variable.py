# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Instrumental variables, and the compliance and target of a robot."""

from __future__ import annotations

from functools import lru_cache
from math import nan
from typing import Any

from contact_estimation.estimators.instrumental_variable import (
    InstrumentalVariable, InstrumentalVariableParameters)
from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.pipeline.arm_outputs import step_along
from contact_estimation.reference.parameters import PoseLimits
from core_runs import closed_loop, contact_samples, estimates_of, pipeline_with
from core_steps import known, learn
import numpy as np
from numpy.typing import NDArray
import pytest


K, B, T, LAG = 4800.0, 200.0, 0.002, 10
POSITION_NOISE, SEEDS = 1e-4, 3
PLAIN = ['rls', 'kalman', 'indirect_adaptive']


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


@lru_cache(maxsize=None)
def damping_errors(name: str, experiment: str) -> tuple[tuple[float, float], ...]:
    """Error and claimed std of B at the last contact [%], positions noisy, no velocity."""
    found = []
    for seed in range(SEEDS):
        run = closed_loop({}, {
            'sensors.force_noise': 1.0, 'sensors.distribution': 'uniform', 'seed': seed,
            'sensors.position_noise': POSITION_NOISE, 'sensors.publish_velocity': False,
        }, experiment)
        last = max(k for k, truth in enumerate(run.truths) if truth.force < 0.0)
        pipeline = pipeline_with(estimator=name, contact__position_noise=POSITION_NOISE)
        estimate = estimates_of([r.sample for r in run.results[:last + 1]], pipeline)[-1]
        found.append((100.0 * (estimate.damping / B - 1.0), 100.0 * estimate.damping_std / B))
    return tuple(found)


@pytest.mark.slow
@pytest.mark.parametrize('experiment', ['sine', 'multisine', 'none'])
def test_position_noise_does_not_bias_the_damping(experiment: str) -> None:
    errors = [error for error, _ in damping_errors('instrumental_variable', experiment)]
    assert abs(np.mean(errors)) < 1.5  # its standard deviation: 0.9 % / sqrt(3)


@pytest.mark.slow
@pytest.mark.parametrize('name', PLAIN)
def test_position_noise_biases_the_others_downwards(name: str) -> None:
    errors = [error for error, _ in damping_errors(name, 'none')]
    assert max(errors) < -4.0  # every one of them


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
