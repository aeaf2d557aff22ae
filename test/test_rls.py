# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recursive least squares against batch weighted least squares in the paper's coordinates."""

from __future__ import annotations

from typing import Any

from contact_estimation.estimators.estimate import Frozen
from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.estimators.rls import (
    initial_covariance,
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


def test_initial_covariance_is_that_of_A_B_C_in_the_estimated_coordinates() -> None:
    expected = 16.0 * J @ (1e5 * np.eye(3)) @ J.T
    upper = expected[np.triu_indices(3)]
    np.testing.assert_allclose(initial_covariance(1e5, T), upper, rtol=1e-12, atol=1e-12)


def test_noise_free_data_give_stiffness_damping_and_inertia() -> None:
    (*_, last) = learn_all(estimator(), signals(1500))
    np.testing.assert_allclose(last, [K, B, M], rtol=0.01)


def test_covariance_does_not_wind_up_without_excitation() -> None:
    rls = estimator()
    learn_all(rls, signals(400, noise=0.5), 0.25)
    still = np.column_stack([np.full(20_000, 0.01), np.full(20_000, 48.0)])
    learn_all(rls, still, 0.25)
    claimed = known(rls)
    assert claimed.stiffness_std < 0.11 * K and claimed.damping_std < 0.11 * B


def test_estimates_stay_after_a_long_stretch_without_excitation() -> None:
    rls = estimator()
    learn_all(rls, signals(400, noise=0.5), 0.25)
    noise = 0.5 * np.random.default_rng(8).standard_normal(10_000)
    learn_all(rls, np.column_stack([np.full(10_000, 0.01), 48.0 + noise]), 0.25)
    np.testing.assert_allclose([rls.stiffness, rls.damping], [K, B], rtol=0.3)


def test_damping_is_never_negative_on_an_undamped_wall() -> None:
    estimates = learn_all(estimator(), signals(2000, noise=2.0, B_e=0.0), 4.0)
    assert min(B_hat for _, B_hat, _ in estimates) >= 0.0


def test_stiffness_survives_the_limit_of_the_damping() -> None:
    rls = estimator(forgetting_factor=1.0)
    (*_, last) = learn_all(rls, signals(2000, noise=2.0, B_e=0.0), 4.0)
    assert last[0] == pytest.approx(K, rel=0.02)


@pytest.mark.parametrize('frozen', [Frozen(True, False), Frozen(False, True), Frozen(True, True)])
def test_frozen_parameters_do_not_move(frozen: Frozen) -> None:
    (*_, last) = learn_all(estimator(), signals(60), 0.1, frozen)
    moved = [last[0] != 3000.0, last[1] != 50.0]
    assert moved == [not frozen.stiffness, not frozen.damping]


def test_inertia_is_zero_for_the_fit_and_nan_for_the_reader_when_not_estimated() -> None:
    rls = estimator(estimate_inertia=False)
    learn_all(rls, signals(400))
    assert np.isnan(known(rls).inertia) and rls.stiffness == pytest.approx(K, rel=0.2)


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


def withdrawal(seed: int) -> NDArray[np.float64]:
    """Return penetration and force: motion, then a slow retreat, whose speed hardly changes."""
    t = T * np.arange(2000)
    retreat = 0.004 * np.clip(t - 2.0, 0.0, None)
    d = 0.01 + 0.002 * np.sin(20.0 * t) * (t < 2.0) - retreat
    v = 0.04 * np.cos(20.0 * t) * (t < 2.0) - 0.004 * (t > 2.0)
    return np.column_stack([d, K * d + B * v + 0.1 * np.random.default_rng(seed).standard_normal(
        len(t))])


def test_retreat_at_a_constant_speed_moves_stiffness_and_damping_within_their_deviations() -> None:
    z = []
    for seed in range(8):
        rls = estimator(estimate_inertia=False)
        learn_all(rls, withdrawal(seed), 0.01)
        now = known(rls)
        z.append([(rls.stiffness - K) / now.stiffness_std, (rls.damping - B) / now.damping_std])
    assert np.max(np.sqrt(np.mean(np.square(z), axis=0))) < 2.0
