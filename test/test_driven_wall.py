# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The attached wall without a robot, and the plant on a sampled reference."""

from __future__ import annotations

from typing import Any

from contact_estimation.physics import EFFECTS
from contact_estimation.plant.driven_wall import run_driven_wall
from effect_examples import example_values
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from world_reference import plant_with, SMOOTH, with_effect

WALL: dict[str, Any] = {
    'environment__stiffness': 1200.0, 'environment__damping': 12.0, 'environment__inertia': 0.6,
    'environment__unilateral': False,
}
T = np.arange(600) / 500.0
FORCE = 8.0 * np.sin(11.0 * T) + 3.0 * np.cos(37.0 * T)
LAWS: dict[str, Any] = {
    'cubic_stiffness': lambda x, v, K_3: K_3 * x**3,
    'quadratic_damping': lambda x, v, B_2: B_2 * v * abs(v),
    'coulomb_friction': lambda x, v, F_c: F_c * np.tanh(v / 4e-4),
}


@pytest.mark.slow
@pytest.mark.parametrize('name', LAWS)
def test_driven_wall_is_that_of_an_independent_integration(name: str) -> None:
    def rates(t: float, s: list[float]) -> list[float]:
        law = 1200.0 * s[0] + 12.0 * s[1] + LAWS[name](*s, *example_values(name))
        return [s[1], (-np.interp(t, T, FORCE) - law) / 0.6]

    expected = solve_ivp(rates, (0.0, T[-1]), [0.001, 0.02], t_eval=T, max_step=1e-3, **SMOOTH)
    got = run_driven_wall(
        with_effect(name, **WALL, integration_rate=20000.0), T, FORCE, 0.001, 0.02)
    np.testing.assert_allclose(got, expected.y[0], atol=1e-7)


@pytest.mark.parametrize('name', [n for n, cls in EFFECTS.items() if cls.port == 'force_sensor'])
def test_sensor_s_physics_are_taken_out_of_the_force(name: str) -> None:
    if name == 'force_saturation':
        pytest.skip('what was clipped is lost')
    model = with_effect(name, **WALL)
    nominal = run_driven_wall(plant_with(**WALL), T, FORCE, 0.0)
    effect = getattr(model.physics, name)
    acceleration = np.gradient(np.gradient(nominal, T), T)
    reading = effect.sense_along(T, FORCE, acceleration)  # type: ignore[union-attr]
    got = run_driven_wall(model, T, reading, 0.0)
    swing = np.max(np.abs(nominal))
    untold = np.max(np.abs(run_driven_wall(plant_with(**WALL), T, reading, 0.0) - nominal))
    assert np.max(np.abs(got - nominal)) < min(0.05 * swing, 0.5 * untold)
