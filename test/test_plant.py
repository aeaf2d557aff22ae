# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The plant: world, driven wall, and the laws of effects in it."""

from functools import lru_cache, partial
from typing import Any, Callable

from contact_estimation.physics import EFFECTS
from contact_estimation.plant.closed_loop import push, Sensors
from contact_estimation.plant.driven_wall import run_driven_wall
from contact_estimation.plant.world import Truth, World
from contact_estimation.reference.reference_generator import quintic
from effect_examples import example_values
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
import world_reference as other
from world_reference import (
    B_e, control, K_e, K_t, M_t, plant_with, simulate, SMOOTH, solve_contact, spring_damper, START,
    with_effect)

T: NDArray[np.float64] = np.linspace(0.0, 1.398, 700)


def hold(t: float) -> tuple[float, float, float, float]:
    """Step the reference to 10 mm."""
    return 0.01, 0.0, 0.0, 0.0


def positions_of(truths: list[Any]) -> NDArray[np.float64]:
    """Positions of a run."""
    return np.array([truth.position for truth in truths])


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
    got = positions_of(simulate(len(T), plant_with()))
    np.testing.assert_allclose(got, solve_contact(T), atol=1e-7, rtol=0.0)


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
        sensors.measure(Truth(0.002 * k, 0.0123, 0.2, 0.0, -49.0, -50.0)) for k in range(count)])


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


WALL: dict[str, Any] = {
    'environment__stiffness': 1200.0, 'environment__damping': 12.0, 'environment__inertia': 0.6,
    'environment__unilateral': False,
}
TIMES = np.arange(600) / 500.0
FORCE = 8.0 * np.sin(11.0 * TIMES) + 3.0 * np.cos(37.0 * TIMES)
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
        return [s[1], (-np.interp(t, TIMES, FORCE) - law) / 0.6]

    expected = solve_ivp(
        rates, (0.0, TIMES[-1]), [0.001, 0.02], t_eval=TIMES, max_step=1e-3, **SMOOTH)
    got = run_driven_wall(
        with_effect(name, **WALL, integration_rate=20000.0), TIMES, FORCE, 0.001, 0.02)
    np.testing.assert_allclose(got, expected.y[0], atol=1e-7)


@pytest.mark.parametrize('name', [n for n, cls in EFFECTS.items() if cls.port == 'force_sensor'])
def test_sensor_s_physics_are_taken_out_of_the_force(name: str) -> None:
    if name == 'force_saturation':
        pytest.skip('what was clipped is lost')
    model = with_effect(name, **WALL)
    nominal = run_driven_wall(plant_with(**WALL), TIMES, FORCE, 0.0)
    effect = getattr(model.physics, name)
    acceleration = np.gradient(np.gradient(nominal, TIMES), TIMES)
    reading = effect.sense_along(TIMES, FORCE, acceleration)  # type: ignore[union-attr]
    got = run_driven_wall(model, TIMES, reading, 0.0)
    swing = np.max(np.abs(nominal))
    untold = np.max(np.abs(run_driven_wall(plant_with(**WALL), TIMES, reading, 0.0) - nominal))
    assert np.max(np.abs(got - nominal)) < min(0.05 * swing, 0.5 * untold)


INDEPENDENT: dict[str, Callable[..., dict[str, Any]]] = {
    'robot_friction': lambda F_c: {
        'drive': lambda t, x, v: control(t, x, v) - F_c * np.tanh(v / 4e-4)},
    'robot_drag': lambda c: {
        'drive': lambda t, x, v: control(t, x, v) - c * v * abs(v)},
    'tool_weight': lambda W: {'drive': lambda t, x, v: control(t, x, v) + W},
    'gravity_error': lambda F_g: {'drive': lambda t, x, v: control(t, x, v) + F_g},
    'impedance_mismatch': lambda K, B, M: {
        'drive': lambda t, x, v: control(t, x, v, M * M_t, B * 1000.0, K * K_t), 'mass': M * M_t},
    'reflected_inertia': lambda M_r: {'mass': M_t + M_r},
    'actuator_saturation': lambda limit: {
        'drive': lambda t, x, v: max(-limit, min(limit, control(t, x, v)))},
    'torque_saturation': lambda limit: {
        'drive': lambda t, x, v: limit * np.tanh(control(t, x, v) / limit)},
    'command_delay': lambda delay: {'drive': lambda t, x, v: (
        control(t - delay, x, v))},
}
"""By effect: its law in the words of `solve_contact`, from its parameters."""


@lru_cache(maxsize=None)
def positions(name: str, integration_rate: float = 5e3, **values: Any) -> Any:
    """Simulate with an effect, or without where the name is empty, once; (N,) [m]."""
    make = partial(with_effect, name) if name else plant_with
    world = make(integration_rate=integration_rate, **values)
    return np.array([truth.position for truth in simulate(len(T), world)])


def test_every_effect_of_the_robot_is_compared() -> None:
    compared = {*INDEPENDENT, 'actuator_lag', 'joint_flexibility'}
    assert {name for name, cls in EFFECTS.items() if cls.port == 'robot'} <= compared


def test_world_is_that_of_an_independent_integration() -> None:
    for name in INDEPENDENT:
        independent = {'law': spring_damper, **INDEPENDENT[name](*example_values(name))}
        expected = solve_contact(T, **independent)
        np.testing.assert_allclose(positions(name), expected, atol=2e-7, rtol=0.0, err_msg=name)
        assert np.max(np.abs(expected - positions(''))) > 1e-5, name


def slow_drives(tau: float) -> tuple[Any, list[float]]:
    """Return the rates of x, v and the force of the drives, and their start."""
    def rates(t: float, s: list[float]) -> list[float]:
        acceleration = (s[2] - K_e * s[0] - B_e * s[1]) / M_t
        return [s[1], acceleration, (control(t, s[0], s[1]) - s[2]) / tau]

    return rates, [START, 0.0, control(0.0, START, 0.0)]


def joint(compliance: float, share: float, ratio: float) -> tuple[Any, list[float]]:
    """Return the rates of position and velocity of motor and link, and their start."""
    m, c = share * M_t, 2.0 * ratio * np.sqrt(share * M_t / compliance)

    def rates(t: float, s: list[float]) -> list[float]:
        x, v, y, w = s
        f = (x - y) / compliance + c * (v - w)
        return [v, (control(t, x, v) - f) / (M_t - m), w, (f - K_e * y - B_e * w) / m]

    return rates, [START, 0.0, START, 0.0]


@pytest.mark.parametrize('name, independent', [
    ('actuator_lag', slow_drives), ('joint_flexibility', joint)])
def test_robot_with_states_is_that_of_an_independent_integration(
    name: str, independent: Callable[..., tuple[Any, list[float]]]
) -> None:
    rates, begin = independent(*example_values(name))
    expected = solve_ivp(rates, (0.0, T[-1]), begin, t_eval=T, max_step=2e-3, **SMOOTH)
    got = positions(name, environment__unilateral=False)
    np.testing.assert_allclose(got, expected.y[0], atol=1e-8)
    assert np.max(np.abs(got - positions('', environment__unilateral=False))) > 1e-4


@pytest.mark.slow
def test_two_integration_steps_a_sample_are_enough() -> None:
    for name in {c.family: n for n, c in EFFECTS.items()}.values():
        coarse, fine = positions(name, integration_rate=1e3), positions(name)
        swing = np.max(fine) - np.min(fine)
        assert np.sqrt(np.mean((coarse - fine) ** 2)) < 1e-3 * swing, name
