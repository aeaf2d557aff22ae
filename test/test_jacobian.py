# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Derivatives that a search keeps up to date."""

from __future__ import annotations

from contact_estimation.diagnosis.fit.jacobian import differentiate_by, SecantJacobian
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.optimize import least_squares

Array = NDArray[np.float64]

SIZE, MOST = np.array([1.0, 2.0]), np.array([9.0, 9.0])
AT = np.linspace(0.0, 2.0, 40)


def test_forward_differences_step_back_from_an_upper_bound() -> None:
    values = np.array([9.0, 3.0])
    asked: list[Array] = []

    def function(these: Array) -> Array:
        asked.append(these)
        return np.array([these[0] * these[1], these[0] ** 2])

    columns = differentiate_by(values, SIZE, function, function(values), most=MOST)
    assert max(float(these[0]) for these in asked) <= 9.0
    np.testing.assert_allclose(columns / SIZE, [[3.0, 9.0], [18.0, 0.0]], atol=1e-3)


class Counted:
    """Exponential decays, and how often they were evaluated."""

    def __init__(self) -> None:
        self.count = 0

    def __call__(self, values: Array) -> Array:
        self.count += 1
        return np.asarray(values[0] * np.exp(-values[1] * AT) - 2.0 * np.exp(-0.7 * AT))


def test_updated_derivatives_find_the_optimum_for_fewer_evaluations() -> None:
    updated, differenced = Counted(), Counted()
    secant = SecantJacobian(updated, SIZE, MOST)
    start, bounds = np.array([1.6, 1.0]), (np.zeros(2), MOST)
    found = least_squares(secant.residuals, start, secant.jacobian, bounds=bounds)
    assert secant.updated
    assert found.x == pytest.approx([2.0, 0.7], rel=1e-5)
    usual = least_squares(differenced, start, bounds=bounds)
    assert usual.x == pytest.approx([2.0, 0.7], rel=1e-5)
    assert updated.count < differenced.count


def test_updated_derivatives_meet_the_last_change() -> None:
    function = Counted()
    secant = SecantJacobian(function, SIZE, MOST)
    first, second = np.array([1.6, 1.0]), np.array([1.7, 0.9])
    before = secant.jacobian(first)
    changed = secant.residuals(second) - secant.residuals(first)
    after = secant.jacobian(second)
    assert secant.updated and not np.allclose(before @ (second - first), changed, rtol=1e-3)
    np.testing.assert_allclose(after @ (second - first), changed, rtol=1e-9, atol=1e-12)


def test_derivatives_that_fail_to_predict_are_differenced_anew() -> None:
    function = Counted()
    secant = SecantJacobian(function, SIZE, MOST)
    secant.jacobian(np.array([1.6, 1.0]))
    far = np.array([0.1, 8.0])
    columns = secant.jacobian(far)
    assert not secant.updated
    np.testing.assert_allclose(columns[:, 0], np.exp(-8.0 * AT), atol=1e-6)
    secant.renew()
    secant.jacobian(far)
    assert not secant.updated


@pytest.mark.parametrize('ends', [{'evaluations': 1}, {'gain': 0.9}])
def test_after_its_last_step_a_search_differences_nothing(ends: dict[str, float]) -> None:
    function = Counted()
    secant = SecantJacobian(function, SIZE, MOST)
    first, last = np.array([1.6, 1.0]), np.array([1.7, 4.0])
    secant.residuals(first)
    secant.renew(**ends)
    secant.jacobian(first)
    secant.residuals(last)
    count = function.count
    secant.jacobian(last)
    assert function.count == count


def test_a_search_that_goes_on_differences_where_updates_fail() -> None:
    function = Counted()
    secant = SecantJacobian(function, SIZE, MOST)
    first, next_one = np.array([1.6, 1.0]), np.array([1.7, 4.0])
    secant.residuals(first)
    secant.renew(evaluations=2)
    secant.jacobian(first)
    secant.residuals(next_one)
    count = function.count
    secant.jacobian(next_one)
    assert function.count == count + len(SIZE)
