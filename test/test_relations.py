# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Relations between force and motion against solutions of the differential equation."""

from __future__ import annotations

from math import nan

from contact_estimation.signals.relations import Relation, TustinRelation, VelocityRelation
from core_steps import row_of
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.integrate import solve_ivp

M, B, K, T = 3.0, 200.0, 4800.0, 0.002
THETA_2, THETA_3 = np.array([K, B]), np.array([K, B, M])


def press(t: float) -> float:
    """Force of a smooth push on the environment [N]."""
    return float(40.0 + 20.0 * np.sin(11.0 * t) + 10.0 * np.sin(23.0 * t))


def motion_under(mass: float, period: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Solve M a + B v + K d = f(t) from the steady start, sampled over 1 s."""
    t = np.arange(0.0, 1.0, period)
    solution = solve_ivp(
        lambda t, s: [s[1], (press(t) - B * s[1] - K * s[0]) / mass], (0.0, 1.0),
        [40.0 / K, 0.0], 'DOP853', t_eval=t, rtol=1e-11, atol=1e-14,
    )
    return t, solution.y


def tustin_residual(period: float) -> float:
    """Largest departure of the ODE's solution from the bilinear relation [N]."""
    t, (d, _) = motion_under(M, period)
    relation = TustinRelation(period)
    rows = [row_of(relation, period, x, nan, press(u), True)
            for u, x in zip(t.tolist(), d.tolist())]
    made = np.array(rows[2:])
    return float(np.max(np.abs(made[:, 0] - made[:, [1, 2, 4]] @ THETA_3)))


def test_bilinear_relation_holds_on_a_solution_of_the_equation() -> None:
    assert tustin_residual(T) < 0.03  # of 70 N


def test_bilinear_row_is_a_quarter_of_the_paper_s_A_B_C_form() -> None:
    d, F = np.random.default_rng(4).normal(0.0, 1.0, (2, 3))
    relation = TustinRelation(T)
    for k in range(3):
        row = row_of(relation, T, d[k], nan, F[k], True)
    assert row is not None
    A = M * (2 / T) ** 2 + B * (2 / T) + K
    B_31 = 2 * K - 2 * M * (2 / T) ** 2
    C = M * (2 / T) ** 2 - B * (2 / T) + K
    assert 4.0 * row[0] == pytest.approx(F[2] + 2.0 * F[1] + F[0])
    right = 4.0 * (K * row[1] + B * row[2] + M * row[4])
    assert right == pytest.approx(A * d[2] + B_31 * d[1] + C * d[0], rel=1e-12)


def test_trapezoid_without_velocity_is_exact_for_parabolic_motion() -> None:
    relation, rows = VelocityRelation(T), []
    for t in (0.0, T, 2.0 * T, 3.0 * T):
        d, v = 0.01 + 0.3 * t - 40.0 * t**2, 0.3 - 80.0 * t
        rows.append(row_of(relation, T, d, nan, K * d + B * v, True))
    made = np.array(rows[1:])
    np.testing.assert_allclose(made[:, 1:3] @ THETA_2, made[:, 0], rtol=1e-12)


@pytest.mark.parametrize('cls, needed', [(VelocityRelation, 2), (TustinRelation, 3)])
def test_rows_do_not_reach_across_a_missing_sample(cls: type[Relation], needed: int) -> None:
    relation = cls(T)
    spacing = [T] * 5 + [2.0 * T] + [T] * 5
    rows = [row_of(relation, dt, 0.01 * k, nan, 1.0, True) for k, dt in enumerate(spacing)]
    assert [k for k, row in enumerate(rows) if k >= 5 and row is not None][0] == 5 + needed - 1
