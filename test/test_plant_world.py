# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The simulated world against closed forms and an independent integration with events."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Any

from contact_estimation.parameters.specification import parameter, ParameterGroup
from contact_estimation.physics.contact_effect import ContactEffect
from contact_estimation.physics.force_sensor_effect import ForceSensorEffect
from contact_estimation.physics.robot_effect import RobotEffect
from contact_estimation.plant.closed_loop import push
from contact_estimation.plant.world import World
from contact_estimation.reference.reference_generator import quintic
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
import world_reference as other
from world_reference import B_e, K_e, plant_with, register, simulate, solve_contact, with_effect

T: NDArray[np.float64] = np.linspace(0.0, 1.398, 700)


@dataclass(frozen=True)
class OneParameter(ParameterGroup):
    """One number that switches an effect of a test on."""

    size: float = parameter(nan, 'Of the effect in this test', nan_is_off=True)


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


def test_free_robot_follows_a_reference_with_derivatives_exactly() -> None:
    truths = simulate(700, plant_with(environment__location=1.0))
    expected = [other.reference_at(t)[0] for t in T]
    np.testing.assert_allclose(positions_of(truths), expected, atol=1e-10)


def test_contact_is_that_of_an_integration_with_events() -> None:
    assert_same_motion(None)


def test_comparison_presses_lets_go_and_leaves_the_surface() -> None:
    truths = simulate(len(T), plant_with())
    slack = [t for t in truths if t.force == 0.0 and t.position > 0.0]
    assert slack and min(t.force for t in truths) < -20.0
    assert sum(a.force == 0.0 > b.force for a, b in zip(truths, truths[1:])) == 2


def test_true_force_is_the_wall_s_equation_or_zero() -> None:
    for truth in simulate(len(T), plant_with()):
        law = -(K_e * truth.position + B_e * truth.velocity)
        expected = min(0.0, law) if truth.position > 0.0 else 0.0
        assert truth.force == pytest.approx(expected, abs=1e-9)


def test_true_force_is_never_positive_in_a_bouncing_contact() -> None:
    bouncing = plant_with(robot__damping=20.0, environment__stiffness=1e6)
    assert max(t.force for t in simulate(1500, bouncing, hold)) <= 0.0


def test_passive_robot_gains_no_energy_from_the_wall() -> None:
    truths = simulate(1500, plant_with(robot__damping=50.0, environment__damping=20.0), hold)
    energy = np.array([
        25.0 * t.velocity**2 + 2500.0 * (t.position - 0.01) ** 2
        + (0.5 * K_e * t.position**2 if t.force < 0.0 else 0.0)
        for t in truths
    ])
    assert np.all(np.diff(energy) <= 1e-10 * energy[0])


def test_acceleration_obeys_newton() -> None:
    for truth in simulate(len(T), plant_with())[::7]:
        u = other.control(truth.t, truth.position, truth.velocity)
        assert 50.0 * truth.acceleration == pytest.approx(u + truth.force, abs=1e-9)


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


@pytest.mark.slow
@pytest.mark.parametrize('changes', [{}, {'environment__damping': 0.0}])
def test_result_does_not_depend_on_the_integration_rate(changes: dict[str, Any]) -> None:
    coarse, fine = (
        positions_of(simulate(len(T), plant_with(integration_rate=rate, **changes)))
        for rate in (5e3, 2e4)
    )
    np.testing.assert_allclose(coarse, fine, atol=1e-8, rtol=0.0)


def test_bilateral_wall_pulls_as_a_linear_system() -> None:
    def rates(t: float, s: list[float]) -> list[float]:
        return [s[1], (other.control(t, *s) - K_e * s[0] - B_e * s[1]) / 50.0]

    expected = solve_ivp(rates, (0.0, T[-1]), [other.START, 0.0], t_eval=T, **other.SMOOTH).y[0]
    truths = simulate(len(T), plant_with(environment__unilateral=False))
    np.testing.assert_allclose(positions_of(truths), expected, atol=1e-9)
    assert max(t.force for t in truths) > 5.0


def test_force_tracking_adds_the_wanted_force() -> None:
    tracking = plant_with(robot__force_tracking=True, environment__location=1.0)
    last = simulate(2000, tracking, lambda t: (0.0, 0.0, 0.0, 50.0), 0.0)[-1]
    assert last.position == pytest.approx(50.0 / 5000.0, rel=1e-6)


def test_force_that_is_not_wanted_is_not_tracked() -> None:
    tracking = plant_with(robot__force_tracking=True)
    assert simulate(10, tracking, lambda t: (-0.1, 0.0, 0.0, nan), -0.1)[-1].position == -0.1


def test_coulomb_friction_is_that_of_an_independent_integration() -> None:
    assert_same_motion(
        plant_with(physics__coulomb_friction__F_c=6.0).physics,
        law=lambda t, d, v: K_e * d + B_e * v + 6.0 * np.tanh(v / 4e-4),
    )


def test_environment_inertia_is_that_of_an_independent_integration() -> None:
    assert_same_motion(plant_with(physics__environment_inertia__M_e=8.0).physics, M_e=8.0)


def test_inertia_of_the_wall_is_that_of_the_effect() -> None:
    wall, effect = (
        simulate(len(T), inert)
        for inert in (plant_with(environment__inertia=8.0),
                      plant_with(physics__environment_inertia__M_e=8.0))
    )
    assert wall == effect


def test_touch_down_on_an_inert_wall_is_no_impulse() -> None:
    truths = simulate(len(T), plant_with(environment__inertia=8.0))
    speed_changes = np.abs(np.diff([t.velocity for t in truths]))
    assert np.max(speed_changes) < 0.01


def test_effect_can_move_the_surface(monkeypatch: pytest.MonkeyPatch) -> None:
    class Moving(ContactEffect):
        name, equation, Parameters = 'test_moving', 'x_e += s', OneParameter

        def surface(self, t: Any, state: Any, m: Any) -> tuple[Any, Any]:
            return 0.002 * m.sin(12.0 * t), 0.024 * m.cos(12.0 * t)

    physics = register(monkeypatch, Moving)
    assert_same_motion(
        physics, surface=lambda t: (0.002 * np.sin(12.0 * t), 0.024 * np.cos(12.0 * t))
    )


def test_effect_can_replace_the_spring(monkeypatch: pytest.MonkeyPatch) -> None:
    class Cubic(ContactEffect):
        name, equation, Parameters = 'test_cubic', 'F_e -= K_3 d^3', OneParameter

        def spring(self, t: Any, d: Any, force: Any, m: Any) -> Any:
            return force + 2e7 * d**3

    physics = register(monkeypatch, Cubic)
    assert_same_motion(physics, law=lambda t, d, v: K_e * d + 2e7 * d**3 + B_e * v)


def test_effect_can_replace_the_damper(monkeypatch: pytest.MonkeyPatch) -> None:
    class HuntCrossley(ContactEffect):
        name, equation, Parameters = 'test_damper', 'chi d v', OneParameter

        def damper(self, d: Any, v: Any, force: Any, exponent: float, m: Any) -> Any:
            return 0.5 * force + 3e4 * d * v

    physics = register(monkeypatch, HuntCrossley)
    assert_same_motion(physics, law=lambda t, d, v: K_e * d + 0.5 * B_e * v + 3e4 * d * v)


def test_effect_can_have_a_state_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    class Relaxation(ContactEffect):
        name, equation, Parameters, states = 'test_state', "s' = K_1 v - s / tau", OneParameter, 1

        def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
            return state[0]

        def state_rates(
            self, t: float, d: float, v: float, contact: bool, state: tuple[float, ...]
        ) -> tuple[float, ...]:
            return (2000.0 * v - state[0] / 0.1,)

    def rates(t: float, s: list[float]) -> list[float]:
        resistance = K_e * s[0] + B_e * s[1] + s[2]
        return [s[1], (other.control(t, s[0], s[1]) - resistance) / 50.0, 2e3 * s[1] - s[2] / 0.1]

    physics = register(monkeypatch, Relaxation)
    got = simulate(len(T), plant_with(physics, environment__unilateral=False))
    expected = solve_ivp(rates, (0.0, T[-1]), [other.START, 0.0, 0.0], t_eval=T, **other.SMOOTH)
    np.testing.assert_allclose(positions_of(got), expected.y[0], atol=1e-8)


def test_effect_knows_whether_there_is_contact(monkeypatch: pytest.MonkeyPatch) -> None:
    class Clock(ContactEffect):
        name, equation, Parameters, states = 'test_clock', 's = time in contact', OneParameter, 1

        def state_rates(
            self, t: float, d: float, v: float, contact: bool, state: tuple[float, ...]
        ) -> tuple[float, ...]:
            return (1.0 if contact else 0.0,)

    world = World(plant_with(register(monkeypatch, Clock)), other.START)
    inside = 0.0
    for _ in range(len(T)):
        world.advance(0.002, other.reference_at)
        inside += 0.002 * (world.truth(other.reference_at).position > 0.0)
    assert world._state[2] == pytest.approx(inside, abs=0.006)


def test_robot_effect_scales_and_limits_the_impedance(monkeypatch: pytest.MonkeyPatch) -> None:
    class Tired(RobotEffect):
        name, equation, Parameters = 'test_tired', 'u clipped', OneParameter
        mass_scale, stiffness_scale, reflected_inertia = 2.0, 0.5, 10.0

        def control(self, u: Any, m: Any) -> Any:
            return min(u, 8.0)

        def drag(self, velocity: Any, m: Any) -> Any:
            return 30.0 * velocity

    def rates(t: float, s: list[float]) -> list[float]:
        u = min(-1000.0 * s[1] - 2500.0 * (s[0] - 0.01), 8.0)
        return [s[1], (u - 30.0 * s[1]) / 110.0]

    physics = register(monkeypatch, Tired)
    got = simulate(500, plant_with(physics, environment__location=1.0), hold, 0.0)
    expected = solve_ivp(rates, (0.0, 1.0), [0.0, 0.0], t_eval=T[:500], max_step=1e-3,
                         **other.SMOOTH)
    np.testing.assert_allclose(positions_of(got), expected.y[0], atol=1e-7)


def test_robot_effect_can_delay_the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    class Late(RobotEffect):
        name, equation, Parameters, reference_delay = 'test_late', 'x_r(t - T)', OneParameter, 0.1

    late = plant_with(register(monkeypatch, Late), environment__location=1.0)
    got = positions_of(simulate(500, late, lambda t: hold(t) if t >= 0.0 else (0.0,) * 4, 0.0))
    assert np.all(got[:50] == 0.0)
    assert got[300] == pytest.approx(0.01 * (1.0 - 6.0 * np.exp(-5.0)), rel=1e-4)


def test_effects_of_the_sensor_follow_at_every_step(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[tuple[float, float]] = []

    class Recorder(ForceSensorEffect):
        name, equation, Parameters = 'test_sensor', 'F 2', OneParameter

        def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
            calls.append((t, dt))
            return 2.0 * force - acceleration

    physics = register(monkeypatch, Recorder)
    for truth in simulate(200, plant_with(physics)):
        assert truth.sensed == 2.0 * truth.force - truth.acceleration
    times, steps = np.array(calls).T
    np.testing.assert_allclose(times, 2e-4 * np.arange(2000), atol=1e-12)
    np.testing.assert_allclose(steps, np.diff(times, prepend=0.0), atol=1e-15)


def test_looking_twice_at_an_instant_senses_it_once() -> None:
    lagging = World(with_effect('force_lag'), 0.005)
    first = lagging.truth(hold)
    lagging.advance(0.01, hold)
    assert lagging.truth(hold) == lagging.truth(hold)
    assert first.sensed == first.force


def test_world_can_be_changed_while_it_runs() -> None:
    world = World(plant_with(), 0.0)
    for stiffness in (4800.0, 9600.0):
        world.configure(plant_with(environment__stiffness=stiffness))
        for _ in range(1000):
            world.advance(0.002, hold)
        expected = -50.0 * stiffness / (stiffness + 5000.0)
        assert world.truth(hold).force == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize('name', ['viscoelastic_relaxation', 'environment_resonance',
                                  'actuator_lag', 'coulomb_friction'])
def test_an_effect_may_be_switched_while_running(name: str) -> None:
    world = World(plant_with(), 0.0)
    for plant in (plant_with(), with_effect(name), plant_with(), with_effect(name)):
        world.configure(plant)
        world.advance(0.8, hold)
        assert (x := world.position) == pytest.approx(50.0 / (5000.0 + K_e), rel=0.02)
    world.configure(with_effect(name, environment__stiffness=2.0 * K_e))  # keeps its past
    world.advance(2e-3, hold)
    assert world.position == pytest.approx(x, rel=0.01)
