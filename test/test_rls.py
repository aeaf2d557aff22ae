# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Recursive least squares, with adaptive forgetting, and with instruments."""

from math import nan
from typing import Any

from contact_estimation.estimators.estimate import Frozen
from contact_estimation.estimators.instrumental_variable import (
    InstrumentalVariable, InstrumentalVariableParameters)
from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.estimators.rls import (
    RecursiveLeastSquares, RecursiveLeastSquaresParameters)
from contact_estimation.estimators.rls_adaptive import (
    AdaptiveLeastSquares, AdaptiveLeastSquaresParameters)
from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.pipeline.arm_outputs import step_along
from contact_estimation.reference.parameters import PoseLimits
from contact_estimation.signals.relations import TustinRelation
from core_runs import contact_samples, estimates_of, FREE, known, learn, pipeline_with, row_of
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
        RecursiveLeastSquaresParameters(**tuning), EnvironmentParameters(), T)


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


STIFFNESS, DAMPING, TIMES, FORCE_STD = 4800.0, 200.0, 0.002, 0.58


def adaptive(**tuning: Any) -> AdaptiveLeastSquares:
    """Make an adaptive with the default first guess."""
    return AdaptiveLeastSquares(
        AdaptiveLeastSquaresParameters(**tuning), EnvironmentParameters(), TIMES)


def rows_with(count: int) -> NDArray[np.float64]:
    """Rows (y, d, v, 1, a) of a sine contact."""
    t = TIMES * np.arange(count)
    d, v = 0.01 + 0.002 * np.sin(20.0 * t), 0.04 * np.cos(20.0 * t)
    y = STIFFNESS * d + DAMPING * v + 0.5 * np.random.default_rng(10).standard_normal(count)
    return np.column_stack([y, d, v, np.ones(count), -400.0 * (d - 0.01)])


def damping_error(name: str) -> float:
    """Return the RMS damping error of an adaptive in the last second of a contact."""
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
    rows, prior = rows_with(400), np.array([2000.0, 100.0])  # which stays clear of all limits
    of = adaptive(
        smallest_forgetting_factor=1.0, inertia_std=0.0, stiffness_std=2000.0, damping_std=100.0)
    for row in rows.tolist():
        learn(of, TIMES, row, 0.25)
    phi = np.vstack([rows[:, 1:3] / 0.5, np.diag(1.0 / prior)])
    y = np.concatenate([rows[:, 0] / 0.5, [3000.0, 50.0] / prior])
    theta = np.linalg.lstsq(phi, y, rcond=None)[0]
    np.testing.assert_allclose([of.stiffness, of.damping], theta, rtol=1e-9)
    spread = np.sqrt(np.diag(np.linalg.inv(phi.T @ phi)))
    np.testing.assert_allclose(known(of)[2:4], spread, rtol=1e-9)


K_IV, B_IV, T_IV, LAG = 4800.0, 200.0, 0.002, 10
POSITION_NOISE = 1e-4


def instrumental(**tuning: Any) -> InstrumentalVariable:
    """Make an estimator with the default first guess."""
    return InstrumentalVariable(
        InstrumentalVariableParameters(**tuning), EnvironmentParameters(), T_IV)


def rows_on(count: int, noise: float = 0.5, seed: int = 10) -> NDArray[np.float64]:
    """Rows (y, d, v, 1, 0) of a sine contact."""
    t = T_IV * np.arange(count)
    d, v = 0.01 + 0.002 * np.sin(20.0 * t), 0.04 * np.cos(20.0 * t)
    errors = noise * np.random.default_rng(seed).standard_normal(count)
    return np.column_stack([K_IV * d + B_IV * v + errors, d, v, np.ones(count), np.zeros(count)])


@pytest.mark.parametrize('name, low, high', [
    ('instrumental_variable', -1.5, 1.5), ('rls', -30.0, -4.0), ('kalman', -30.0, -4.0),
    ('indirect_adaptive', -30.0, -4.0)])
def test_position_noise_biases_the_damping_of_all_others(
    name: str, low: float, high: float
) -> None:
    for seed in range(2):
        samples = contact_samples(4.0, K_IV, B_IV, force_noise=0.58, position_noise=POSITION_NOISE,
                                  with_velocity=False, seed=seed)
        pipeline = pipeline_with(estimator=name, contact__position_noise=POSITION_NOISE)
        assert low < 100.0 * (estimates_of(samples, pipeline)[-1].damping / B_IV - 1.0) < high


def test_recursion_equals_the_batch_solution() -> None:
    rows, keep = rows_on(400), np.exp(-T_IV / 0.5)
    of = instrumental(memory_s=0.5, delay_s=LAG * T_IV, stiffness_std=1e9, damping_std=1e9)
    for row in rows.tolist():
        learn(of, T_IV, row, 0.25)
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
                                 amplitude=10.0 / K_e)]
    plain, known = (
        estimates_of(samples, pipeline_with(
            estimator='rls_adaptive', contact__force_noise=1e-3, robot__compliance=compliance))[-1]
        for compliance in (0.0, C))
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
    ((0.0, 0.0, 0.3), nan, None)])
def test_steps_stay_within_lead_and_box(
    position: tuple[float, ...], step: float, expected: float | None
) -> None:
    assert step_along(position, DOWN, step, BOX) == (
        None if expected is None else pytest.approx(expected))


def test_an_empty_box_is_refused() -> None:
    with pytest.raises(ParameterRangeError, match=r'lower must be <= .*got \[0.0, 0.0, 2.0'):
        PoseLimits(lower=(0.0, 0.0, 2.0), upper=(1.0, 1.0, 1.0))
