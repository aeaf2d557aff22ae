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

"""Model reference adaptive estimation: reference model, arm and environment."""

from __future__ import annotations

from contact_estimation.estimators.estimator import EnvironmentParameters, Held, Reference
from contact_estimation.estimators.mrac import (
    ModelReferenceAdaptive,
    ModelReferenceParameters,
    PlantEstimator,
    ReferenceModel,
)
from core_runs import closed_loop, PAPER_SENSORS
from core_steps import learn
import numpy as np
import pytest
from scipy.integrate import odeint, solve_ivp

M_t, B_t, K_t = 100.0, 6500.0, 1e5
TARGET_IS_NOMINAL = {
    'tuning.mrac.target_mass': 50.0, 'tuning.mrac.target_damping': 1000.0,
    'tuning.mrac.target_stiffness': 5000.0,
}


def reference_at(t: float) -> Reference:
    """Give a smooth reference with its derivatives."""
    return Reference(
        0.01 * np.sin(8.0 * t), 0.08 * np.cos(8.0 * t), -0.64 * np.sin(8.0 * t)
    )


def force_at(t: float) -> float:
    """Give a force that presses back [N]."""
    return float(-40.0 * np.sin(5.0 * t) ** 2)


def model_error(dt: float) -> float:
    """Largest departure of the model from eq. (1), as a share of its greatest motion."""
    def rates(state: list[float], t: float) -> list[float]:
        x, v = state
        x_r, v_r, a_r = reference_at(t)
        return [v, a_r + (force_at(t) - B_t * (v - v_r) - K_t * (x - x_r)) / M_t]

    t = dt * np.arange(round(1.0 / dt) + 1)
    expected = odeint(rates, [0.0, 0.0], t, rtol=1e-10, atol=1e-13)[:, 0]
    model = ReferenceModel(M_t, B_t, K_t)
    model.start(0.0, 0.0)
    positions = [0.0]
    for now in t[1:].tolist():
        model.step(dt, force_at(now), reference_at(now))
        positions.append(model.position)
    return float(np.max(np.abs(positions - expected)) / np.max(np.abs(expected)))


def test_reference_model_solves_the_target_impedance() -> None:
    assert model_error(1e-4) < 2e-3


def test_reference_model_is_close_at_the_node_s_rate() -> None:
    assert model_error(2e-3) < 0.03


def test_reference_model_is_stable_at_any_sample_period() -> None:
    model = ReferenceModel(M_t, B_t, K_t)
    model.start(0.05, 0.0)
    for _ in range(200):
        model.step(0.5, 0.0, Reference(0.0, 0.0, 0.0))
    assert abs(model.position) < 1e-9


@pytest.mark.parametrize('off', [0.7, 1.3])
def test_plant_estimator_recovers_an_arm_that_is_30_percent_off(off: float) -> None:
    true = np.array([5000.0 * off / 50.0, 1000.0 / 50.0, 1.0 / (50.0 * off)])

    def push(t: float) -> float:
        return float(40.0 * np.sin(3.0 * t) + 30.0 * np.sin(11.0 * t) + 20.0 * np.sin(23.0 * t))

    t = 0.002 * np.arange(10_000)
    motion = solve_ivp(
        lambda u, s: [s[1], -true[0] * s[0] - true[1] * s[1] + true[2] * push(u)], (0.0, 20.0),
        [0.0, 0.0], t_eval=t, rtol=1e-8, atol=1e-12, max_step=0.01,
    ).y
    plant = PlantEstimator(60.0, 5.0, (100.0, 20.0, 0.02))
    at_rest = Reference(0.0, 0.0, 0.0)
    for u, x, v in zip(t.tolist(), *motion.tolist()):
        plant.step(0.002, x, v, push(u), at_rest)
    np.testing.assert_allclose(plant.a, true, rtol=0.05)


def test_plant_estimator_stays_in_a_closed_loop_with_the_nominal_arm() -> None:
    run = closed_loop({'estimator': 'mrac', **TARGET_IS_NOMINAL})
    arm = run.session.pipeline.estimator
    assert isinstance(arm, ModelReferenceAdaptive)
    np.testing.assert_allclose(arm.plant.a, [100.0, 20.0, 0.02], rtol=0.1)


def test_plant_estimator_finds_in_a_closed_loop_an_arm_30_percent_too_stiff() -> None:
    run = closed_loop(
        {'estimator': 'mrac', **TARGET_IS_NOMINAL}, {'robot.stiffness': 6500.0}, 'multisine'
    )
    arm = run.session.pipeline.estimator
    assert isinstance(arm, ModelReferenceAdaptive)
    assert arm.plant.a[0] / arm.plant.a[2] == pytest.approx(6500.0, rel=0.1)


def test_model_error_vanishes_where_the_arm_is_the_target() -> None:
    run = closed_loop({'estimator': 'mrac', **TARGET_IS_NOMINAL})
    arm = run.session.pipeline.estimator
    assert isinstance(arm, ModelReferenceAdaptive)
    assert abs(arm.model_error) < 2e-4


def test_environment_estimate_is_that_of_indirect_adaptive() -> None:
    mrac = closed_loop({'estimator': 'mrac'}, PAPER_SENSORS)
    adaptive = closed_loop({'estimator': 'indirect_adaptive'}, PAPER_SENSORS)
    assert mrac.last[:5] == adaptive.last[:5]


def test_new_gain_keeps_what_was_learned_of_the_arm() -> None:
    mrac = ModelReferenceAdaptive(ModelReferenceParameters(), EnvironmentParameters(), 0.002)
    for k in range(200):
        mrac.observe(0.002, 0.01 * np.sin(0.1 * k), 0.5 * np.cos(0.1 * k), -20.0,
                     Reference(0.0, 0.0, 0.0))
    learned = list(mrac.plant.a)
    mrac.configure(ModelReferenceParameters(stiffness_gain=6e4))
    assert mrac.plant.a == learned


def test_new_target_restarts_the_model() -> None:
    mrac = ModelReferenceAdaptive(ModelReferenceParameters(), EnvironmentParameters(), 0.002)
    mrac.configure(ModelReferenceParameters(target_mass=50.0))
    assert (mrac.model.mass, mrac.plant.a[2]) == (50.0, 0.02)


@pytest.mark.parametrize('held', [Held(True, False), Held(False, True), Held(True, True)])
def test_held_parameters_do_not_move(held: Held) -> None:
    mrac = ModelReferenceAdaptive(ModelReferenceParameters(), EnvironmentParameters(), 0.002)
    learn(mrac, 0.002, (60.0, 0.01, 0.05, 1.0), 0.1, held)
    moved = [mrac.stiffness != 3000.0, mrac.damping != 50.0]
    assert moved == [not held.stiffness, not held.damping]
