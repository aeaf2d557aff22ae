# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Forgetting that adapts, next to the fixed one on the same samples."""

from __future__ import annotations

from typing import Any

from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.estimators.rls_adaptive import (
    AdaptiveLeastSquares, AdaptiveLeastSquaresParameters)
from core_runs import contact_samples, estimates_of, pipeline_with
from core_steps import known, learn
import numpy as np
from numpy.typing import NDArray
import pytest

STIFFNESS, DAMPING, TIMES, FORCE_STD = 4800.0, 200.0, 0.002, 0.58


def estimator(**tuning: Any) -> AdaptiveLeastSquares:
    """Make an estimator with the default first guess."""
    return AdaptiveLeastSquares(
        AdaptiveLeastSquaresParameters(**tuning), EnvironmentParameters(), TIMES
    )


def rows_of(count: int) -> NDArray[np.float64]:
    """Rows (y, d, v, 1, a) of a sine contact."""
    t = TIMES * np.arange(count)
    d, v = 0.01 + 0.002 * np.sin(20.0 * t), 0.04 * np.cos(20.0 * t)
    y = STIFFNESS * d + DAMPING * v + 0.5 * np.random.default_rng(10).standard_normal(count)
    return np.column_stack([y, d, v, np.ones(count), -400.0 * (d - 0.01)])


def damping_error(name: str) -> float:
    """Return the RMS damping error of an estimator in the last second of a contact."""
    errors = []
    for seed in range(3):
        samples = contact_samples(2.2, STIFFNESS, DAMPING, force_noise=FORCE_STD, seed=seed)
        made = estimates_of(samples, pipeline_with(estimator=name))
        errors += [e.damping / DAMPING - 1.0 for e in made[-500:]]
    return float(np.sqrt(np.mean(np.square(errors))))


@pytest.mark.slow
def test_damping_is_at_least_twice_as_quiet_as_with_fixed_forgetting() -> None:
    assert damping_error('rls_adaptive') < 0.5 * damping_error('rls')


def test_without_forgetting_it_is_batch_least_squares_with_the_prior() -> None:
    rows, prior = rows_of(400), np.array([2000.0, 100.0])  # which stays clear of all limits
    of = estimator(
        smallest_forgetting_factor=1.0, inertia_std=0.0,
        stiffness_std=2000.0, damping_std=100.0,
    )
    for row in rows.tolist():
        learn(of, TIMES, row, 0.25)
    phi = np.vstack([rows[:, 1:3] / 0.5, np.diag(1.0 / prior)])
    y = np.concatenate([rows[:, 0] / 0.5, [3000.0, 50.0] / prior])
    theta = np.linalg.lstsq(phi, y, rcond=None)[0]
    np.testing.assert_allclose([of.stiffness, of.damping], theta, rtol=1e-9)
    spread = np.sqrt(np.diag(np.linalg.inv(phi.T @ phi)))
    np.testing.assert_allclose(known(of)[2:4], spread, rtol=1e-9)
