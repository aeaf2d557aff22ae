# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recursive least squares against batch weighted least squares in the paper's coordinates."""

from __future__ import annotations

from typing import Any

from contact_estimation.estimators.estimate import Frozen
from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.estimators.rls import (
    RecursiveLeastSquares,
    RecursiveLeastSquaresParameters,
)
from contact_estimation.signals.relations import TustinRelation
from core_steps import FREE, known, learn, row_of
import numpy as np
from numpy.typing import NDArray
import pytest

M, B, K, T = 2.0, 200.0, 4800.0, 0.002
J = np.array([  # eq. (39): (K_e, B_e, M_e) of (A, B, C)
    [0.25, 0.25, 0.25],
    [T / 4.0, 0.0, -T / 4.0],
    [T**2 / 16.0, -T**2 / 16.0, T**2 / 16.0],
])


def estimator(**tuning: Any) -> RecursiveLeastSquares:
    """Make an estimator with the default first guess."""
    return RecursiveLeastSquares(
        RecursiveLeastSquaresParameters(**tuning), EnvironmentParameters(), T
    )


def signals(count: int, noise: float = 0.0, B_e: float = B) -> NDArray[np.float64]:
    """Penetration and force, the latter of the A, B, C recursion's steady state, (count, 2)."""
    t = T * np.arange(count)
    phase = 20.0 * t
    d = 0.01 + 0.002 * np.sin(phase) + 0.0005 * np.sin(3.0 * phase)
    v = 0.04 * np.cos(phase) + 0.03 * np.cos(3.0 * phase)
    a = -0.8 * np.sin(phase) - 1.8 * np.sin(3.0 * phase)
    errors = noise * np.random.default_rng(7).standard_normal(count)
    return np.column_stack([d, K * d + B_e * v + M * a + errors])


def learn_all(
    of: RecursiveLeastSquares, pairs: NDArray[np.float64], variance: float = 0.0,
    frozen: Frozen = FREE,
) -> list[tuple[float, float, float]]:
    """Pass penetration and force through relation and estimator."""
    relation, estimates = TustinRelation(T), []
    for d, F in pairs.tolist():
        row = row_of(relation, T, d, float('nan'), F, True)
        if row is not None:
            learn(of, T, row, variance, frozen)
            estimates.append((of.stiffness, of.damping, known(of).inertia))
    return estimates


@pytest.mark.parametrize('forgetting', [1.0, 0.98, 0.9])
def test_recursion_equals_batch_weighted_least_squares(forgetting: float) -> None:
    pairs = signals(300, noise=0.5)
    d, F = pairs.T
    phi = np.column_stack([d[2:], d[1:-1], d[:-2]])  # (N, 3), eq. (31)
    y = F[2:] + 2.0 * F[1:-1] + F[:-2]
    weights = forgetting ** np.arange(len(y) - 1, -1, -1.0)
    start = np.linalg.solve(J, [3000.0, 50.0, 0.0])
    prior = np.sqrt(forgetting ** len(y) / 1e5)  # P[0] = 1e5 I
    rows = np.vstack([np.sqrt(weights)[:, None] * phi, prior * np.eye(3)])
    right = np.concatenate([np.sqrt(weights) * y, prior * start])
    expected = J @ np.linalg.lstsq(rows, right, rcond=None)[0]
    of = estimator(forgetting_factor=forgetting, initial_covariance=1e5)
    (*_, last) = learn_all(of, pairs)
    np.testing.assert_allclose(last, expected, rtol=1e-5)


def test_covariance_does_not_wind_up_without_excitation() -> None:
    rls = estimator()
    learn_all(rls, signals(400, noise=0.5), 0.25)
    still = np.column_stack([np.full(20_000, 0.01), np.full(20_000, 48.0)])
    learn_all(rls, still, 0.25)
    claimed = known(rls)
    assert claimed.stiffness_std < 0.11 * K and claimed.damping_std < 0.11 * B


@pytest.mark.parametrize('forgetting', [1.0, 0.98])
def test_claimed_std_is_the_spread_over_noise(forgetting: float) -> None:
    relation = TustinRelation(T)
    made = [row_of(relation, T, d, float('nan'), F, True) for d, F in signals(402).tolist()]
    rows = [row for row in made if row is not None]
    random, finals = np.random.default_rng(9), []
    for _ in range(120):
        rls = estimator(forgetting_factor=forgetting, initial_covariance=1e10)
        for row, error in zip(rows, random.standard_normal(len(rows)).tolist()):
            learn(rls, T, (row[0] + 0.5 * error, *row[1:]), 0.25)
        finals.append([rls.stiffness, rls.damping])
    claimed = known(rls)[2:4]
    np.testing.assert_allclose(np.std(finals, axis=0), claimed, rtol=0.25)
