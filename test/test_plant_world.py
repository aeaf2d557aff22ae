# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The simulated world and its sensors against closed forms and an independent integration."""

from __future__ import annotations

from typing import Any

from contact_estimation.estimators.contact_model import kelvin_voigt_force
from contact_estimation.exceptions import ParameterRangeError, SignalShapeError
from contact_estimation.plant.closed_loop import push, Sensors
from contact_estimation.plant.world import Truth, World
from contact_estimation.reference.reference_generator import quintic
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
import world_reference as other
from world_reference import B_e, K_e, plant_with, simulate, solve_contact

T: NDArray[np.float64] = np.linspace(0.0, 1.398, 700)


def hold(t: float) -> tuple[float, float, float, float]:
    """Step the reference to 10 mm."""
    return 0.01, 0.0, 0.0, 0.0


def positions_of(truths: list[Any]) -> NDArray[np.float64]:
    """Positions of a run."""
    return np.array([truth.position for truth in truths])


def assert_same_motion(physics: Any, **independent: Any) -> None:
    """Compare the world with an effect to the independent integration, to 1e-7 m."""
    got = positions_of(simulate(len(T), plant_with(physics)))
    np.testing.assert_allclose(got, solve_contact(T, **independent), atol=1e-7, rtol=0.0)


def test_free_robot_follows_the_closed_form_of_the_impedance() -> None:
    # Critically damped at 10 rad/s: x = x_r (1 - (1 + 10 t) exp(-10 t)).
    got = positions_of(simulate(500, plant_with(environment__location=1.0), hold, 0.0))
    t = 0.002 * np.arange(500)
    expected = 0.01 * (1.0 - (1.0 + 10.0 * t) * np.exp(-10.0 * t))
    np.testing.assert_allclose(got, expected, atol=1e-12)


def test_bare_arm_under_a_constant_push_follows_the_closed_form() -> None:
    arm = plant_with(environment__location=1.0, robot__control='force', robot__mass=25.0,
                     robot__damping=100.0)
    got = positions_of(simulate(500, arm, push(30.0), 0.0))
    t = 0.002 * np.arange(500)  # v = 30 / 100 (1 - exp(-100 t / 25))
    expected = 0.3 * (t - 0.25 * (1.0 - np.exp(-4.0 * t)))
    np.testing.assert_allclose(got, expected, atol=1e-10)


def test_contact_is_that_of_an_integration_with_events() -> None:
    assert_same_motion(None)


@pytest.mark.parametrize('location', [0.0, 0.00123, -0.00271])
def test_touch_down_happens_at_the_exact_time(location: float) -> None:
    def approach(t: float) -> tuple[float, float, float, float]:
        return (*quintic(-0.01, 0.01, 0.5, t), 0.0)

    at = float(brentq(lambda t: quintic(-0.01, 0.01, 0.5, t)[0] - location, 0.0, 0.5, xtol=1e-14))
    forces = []
    for end in (at - 1e-8, at + 1e-8):
        world = World(plant_with(environment__location=location), -0.01)
        for k in range(100):
            world.advance(end / 100.0, approach)
        forces.append(world.truth(approach).force)
    assert forces[0] == 0.0 > forces[1]


def test_bilateral_wall_pulls_as_a_linear_system() -> None:
    def rates(t: float, s: list[float]) -> list[float]:
        return [s[1], (other.control(t, *s) - K_e * s[0] - B_e * s[1]) / 50.0]

    expected = solve_ivp(rates, (0.0, T[-1]), [other.START, 0.0], t_eval=T, **other.SMOOTH).y[0]
    truths = simulate(len(T), plant_with(environment__unilateral=False))
    np.testing.assert_allclose(positions_of(truths), expected, atol=1e-9)
    assert max(t.force for t in truths) > 5.0


NOISY: dict[str, Any] = {
    'sensors__force_noise': 1.0, 'sensors__position_noise': 1e-5, 'sensors__velocity_noise': 1e-3,
}


def measured(count: int = 3000, **values: Any) -> NDArray[np.float64]:
    """Measure 12.3 mm, 0.2 m/s and -49 N, which the sensor takes for -50 N; (count, 3)."""
    sensors = Sensors(plant_with(**values))
    return np.array([
        sensors.measure(Truth(0.002 * k, 0.0123, 0.2, 0.0, -49.0, -50.0)) for k in range(count)
    ])


@pytest.mark.parametrize('off, column', [('force', 0), ('position', 1), ('velocity', 2)])
def test_switching_one_noise_off_leaves_the_others(off: str, column: int) -> None:
    rest = [k for k in range(3) if k != column]
    quiet = measured(**{**NOISY, f'sensors__{off}_noise': 0.0})
    np.testing.assert_array_equal(quiet[:, rest], measured(**NOISY)[:, rest])


def test_normal_noise_has_the_given_standard_deviation() -> None:
    np.testing.assert_allclose(measured(**NOISY).std(axis=0), [1.0, 1e-5, 1e-3], rtol=0.05)


def test_uniform_noise_has_the_spread_of_a_uniform_distribution() -> None:
    error = measured(**NOISY, sensors__distribution='uniform')[:, 0] + 50.0
    assert np.std(error) == pytest.approx(1.0 / np.sqrt(3.0), rel=0.03)


def test_position_is_quantised_after_its_noise() -> None:
    x = measured(**NOISY, sensors__position_quantisation=5e-6)[:, 1] / 5e-6
    np.testing.assert_allclose(x, np.round(x), atol=1e-6)
    assert len(set(np.round(x))) > 3


def test_velocity_is_nan_where_it_is_not_published() -> None:
    assert np.all(np.isnan(measured(5, sensors__publish_velocity=False)[:, 2]))


def test_force_on_a_pressing_tool_is_negative_by_hand() -> None:
    assert kelvin_voigt_force(0.01, 0.1, 4800.0, 200.0) == pytest.approx(-(48.0 + 20.0))


def test_wall_cannot_pull_while_withdrawing_inside_the_surface() -> None:
    speeds = np.linspace(-10.0, 10.0, 401)
    force = kelvin_voigt_force(np.full(401, 0.001), speeds, 4800.0, 200.0)
    assert np.all(force <= 0.0)
    assert np.all(force[speeds < -4.8 / 200.0 - 1e-9] == 0.0)


def test_different_shapes_are_refused() -> None:
    with pytest.raises(SignalShapeError, match=r'one shape, got \(3,\) and \(2,\)'):
        kelvin_voigt_force([1.0, 2.0, 3.0], [1.0, 2.0], 4800.0, 200.0)


@pytest.mark.parametrize('K_e', [0.0, -5.0, float('nan')])
def test_stiffness_that_is_not_positive_is_refused(K_e: float) -> None:
    with pytest.raises(ParameterRangeError, match='K_e must be > 0 N/m'):
        kelvin_voigt_force(0.0, 0.0, K_e, 0.0)
