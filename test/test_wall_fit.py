# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The fit of a wall over a window against least squares in matrices."""

from __future__ import annotations

from contact_estimation.estimators.wall_fit import fit_wall, misfit, Wall
import numpy as np
from numpy.typing import NDArray
import pytest

GUESS = Wall(3000.0, 50.0, -2.0, 0.0)
WEIGHTS = 1e-5, 1e-3


def rows_of(count: int = 200, shift: float = 1e-3) -> NDArray[np.float64]:
    """Rows (y, d, v, 1, a) of a wall with mass that is elsewhere."""
    t = 0.002 * np.arange(count)
    d, v = 0.01 + 0.002 * np.sin(20.0 * t), 0.04 * np.cos(20.0 * t)
    a = np.sin(31.0 * t)
    noise = 0.3 * np.random.default_rng(0).standard_normal(count)
    y = 4800.0 * (d - shift) + 200.0 * v + 2.0 * a + noise
    return np.column_stack([y, d, v, np.ones(count), a])


def batch(
    rows: NDArray[np.float64], columns: list[int], y: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float, NDArray[np.float64]]:
    """Least squares with the priors as rows."""
    phi = rows[:, columns]
    prior = np.zeros((2, len(columns)))
    prior[0, columns.index(2)] = WEIGHTS[0] ** 0.5
    prior[1, columns.index(4)] = WEIGHTS[1] ** 0.5
    stacked = np.vstack([phi, prior])
    target = np.concatenate([y, [WEIGHTS[0] ** 0.5 * GUESS.damping, 0.0]])
    theta = np.linalg.lstsq(stacked, target, rcond=None)[0]
    left = float(np.sum((target - stacked @ theta) ** 2))
    return theta, left, np.linalg.inv(stacked.T @ stacked)


def test_fit_with_an_offset_is_least_squares() -> None:
    rows = rows_of()
    fit = fit_wall(rows.T @ rows, GUESS, *WEIGHTS)
    assert fit is not None
    theta, left, inverse = batch(rows, [1, 2, 3, 4], rows[:, 0])
    np.testing.assert_allclose(fit.offset_wall, theta, rtol=1e-6)
    assert fit.offset_left == pytest.approx(left, rel=1e-5)
    assert fit.offset_variance == pytest.approx(inverse[2, 2], rel=1e-6)


def test_fit_without_one_keeps_the_guessed_offset() -> None:
    rows = rows_of()
    fit = fit_wall(rows.T @ rows, GUESS, *WEIGHTS)
    assert fit is not None
    y = rows[:, 0] - GUESS.offset
    theta, left, inverse = batch(rows, [1, 2, 4], y)
    np.testing.assert_allclose(np.delete(fit.wall, 2), theta, rtol=1e-6)
    assert fit.wall.offset == GUESS.offset
    assert fit.left == pytest.approx(left, rel=1e-5)
    variances = [fit.stiffness_variance, fit.damping_variance]
    np.testing.assert_allclose(variances, np.diag(inverse)[:2], rtol=1e-6)


def test_misfit_is_the_sum_of_squares() -> None:
    rows, wall = rows_of(), Wall(4700.0, 180.0, -5.0, 1.0)
    expected = np.sum((rows[:, 0] - rows[:, 1:] @ np.array(wall)) ** 2)
    assert misfit(rows.T @ rows, wall) == pytest.approx(expected, rel=1e-9)


def test_rows_without_depth_give_no_fit() -> None:
    rows = rows_of()
    rows[:, 1] = 0.0
    assert fit_wall(rows.T @ rows, GUESS, *WEIGHTS) is None
