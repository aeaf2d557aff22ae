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

"""First steps from the starts of a law, and derivatives that a search keeps up to date."""

from __future__ import annotations

from concealed_worlds import nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.fit.first_step import steps, straight_at
from contact_estimation.diagnosis.fit.fitting import fit
from contact_estimation.diagnosis.fit.jacobian import differentiate_by, SecantJacobian
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.residuals import residuals
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.optimize import least_squares

Array = NDArray[np.float64]

SIZE, MOST = np.array([1.0, 2.0]), np.array([9.0, 9.0])
AT = np.linspace(0.0, 2.0, 40)


def step_from(recording: PreparedRecording, start: Model) -> tuple[float, Model]:
    step = steps([recording], [start])[0]
    return step.cost, step.model


@pytest.mark.slow
def test_step_is_exact_for_what_is_linear() -> None:
    recording, model = prepared_from(recorded(**physics('force_bias', 2.0)))
    start = model.with_effect('force_bias', (0.01,))
    cost, stepped = step_from(recording, start)
    again, _ = step_from(recording, stepped)
    assert stepped.values[-1] == pytest.approx(2.0, rel=0.02)
    assert cost - again < 1e-3 * cost


@pytest.mark.parametrize('times', [0.2, 5.0])
def test_step_is_exact_for_a_linear_value_searched_by_its_logarithm(times: float) -> None:
    recording, model = prepared_from(recorded(**physics('power_law_damping', 1500.0, 0.5)))
    base = fit([recording], model).model
    _, stepped = step_from(recording, base.with_effect('power_law_damping', (times * 1500.0, 0.5)))
    assert stepped.values[-2] == pytest.approx(1500.0, rel=0.05)


def test_step_never_makes_things_worse() -> None:
    recording, model = prepared_from(recorded())
    start = model.with_effect('power_law_stiffness', (2.0, 1e6))
    before = float(np.sum(residuals(recording, start) ** 2))
    assert step_from(recording, start)[0] <= before


@pytest.mark.parametrize('depth', [0.0012, 0.0025, 0.012])
def test_step_finds_the_magnitude_of_a_law_whose_shape_is_far_off(depth: float) -> None:
    recording, model = prepared_from(recorded(**physics('exponential_stiffness', 0.6, 0.0025)))
    without = fit([recording], model)
    wild = 20.0 / np.expm1(0.013 / depth)
    cost, _ = step_from(recording, model.with_effect('exponential_stiffness', (wild, depth)))
    assert cost < 0.5 * without.cost


def test_a_start_that_promises_less_than_another_reaches_is_left() -> None:
    recording, model = prepared_from(recorded(**physics('stribeck_friction', 3.0, 6.0, 0.01)))
    base = fit([recording], model).model
    starts = [base.with_effect('stribeck_friction', (1.0, 2.0, speed))
              for speed in (1e-4, 1e-3, 0.01, 0.1, 1.0)]
    alone = [steps([recording], [start])[0] for start in starts]
    taken = steps([recording], starts)
    assert taken[0].model == min(alone, key=lambda step: step.cost).model
    left = [step for step in taken if step.residuals is None]
    assert left and all(step.model == step.start and step.cost >= taken[0].cost for step in left)


def test_of_starts_near_a_known_model_those_are_differentiated_whose_law_fits_in_size() -> None:
    recording, model = prepared_from(recorded(**physics('presliding_friction', 3.0, 9000.0)))
    base = fit([recording], model).model
    starts = [base.with_effect('presliding_friction', (0.05, 0.05 * rate))
              for rate in (30.0, 300.0, 3000.0, 30000.0, 3e6)]  # of which 3000 is the true one
    before = straight_at([recording], base)
    taken = steps([recording], starts, before)
    assert len(taken) == 3 and taken[0].start == starts[2]
    with_all = steps([recording], starts)
    assert taken[0].cost == pytest.approx(with_all[0].cost, rel=0.05)
    few = steps([recording], starts[:2], before)
    assert {step.start for step in few} == set(starts[:2])


def test_straight_residuals_of_an_attached_spring_and_damper_are_linear_in_both() -> None:
    recording, model = prepared_from(recorded(), nominal(environment__unilateral=False))
    here, columns = straight_at([recording], model)
    stiffer = model.at((1.2 * model.stiffness, 0.9 * model.damping))
    expected = here + columns @ ((stiffer.coordinates - model.coordinates) / model.steps)
    np.testing.assert_allclose(straight_at([recording], stiffer).here, expected, atol=1e-3)


def test_residuals_of_a_step_are_those_of_its_model() -> None:
    recording, model = prepared_from(recorded(**physics('stribeck_friction', 3.0, 6.0, 0.01)))
    step = steps([recording], [model.with_effect('stribeck_friction', (1.0, 2.0, 0.02))])[0]
    assert step.residuals is not None
    np.testing.assert_allclose(step.residuals, residuals(recording, step.model), atol=1e-9)
    assert step.cost == pytest.approx(float(np.sum(step.residuals**2)))
    again = fit([recording], step.model, known=step.residuals)
    assert again.model == fit([recording], step.model).model


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
