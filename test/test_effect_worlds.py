# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The world with each effect against an independent integration by scipy with events."""

from __future__ import annotations

from functools import lru_cache, partial
from typing import Any, Callable

from contact_estimation.physics import EFFECTS
from effect_examples import example_values
from effect_formulas import sliding
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from world_reference import (
    B_e,
    B_t,
    control,
    K_e,
    K_t,
    M_t,
    plant_with,
    simulate,
    SMOOTH,
    solve_contact,
    spring_damper,
    START,
    with_effect,
)

T = np.linspace(0.0, 1.398, 700)


def resisting(more: Callable[..., float]) -> Callable[..., dict[str, Any]]:
    """Add to spring and damper a resistance of (t, d, v, parameters)."""
    return lambda *p: {'law': lambda t, d, v: K_e * d + B_e * v + float(more(t, d, v, *p))}


def swing(*tones: float) -> dict[str, Any]:
    """Move the surface as a sum of sines of amplitude, frequency and phase each."""
    A, f, phase = np.reshape(tones, (-1, 3)).T
    w = 2.0 * np.pi * f
    return {'surface': lambda t: (float(A @ np.sin(w * t + phase)),
                                  float((A * w) @ np.cos(w * t + phase)))}


INDEPENDENT: dict[str, Callable[..., dict[str, Any]]] = {
    'coulomb_friction': resisting(lambda t, d, v, F_c: F_c * np.tanh(v / 4e-4)),
    'stribeck_friction': resisting(lambda t, d, v, *p: sliding(v, *p)),
    'environment_inertia': lambda M_e: {'M_e': M_e},
    'cubic_stiffness': resisting(lambda t, d, v, K_3: K_3 * d**3),
    'power_law_stiffness': resisting(lambda t, d, v, n, K_n: K_n * max(d, 0.0)**n - K_e * d),
    'polynomial_stiffness': resisting(
        lambda t, d, v, K_2, K_3: K_2 * d**2 + K_3 * d**3),
    'exponential_stiffness': resisting(
        lambda t, d, v, A, depth: A * (np.exp(d / depth) - 1.0 - d / depth)),
    'hunt_crossley_damping': resisting(lambda t, d, v, chi: chi * d * v - B_e * v),
    'power_law_damping': resisting(lambda t, d, v, B_m, m: B_m * abs(d)**m * v - B_e * v),
    'asymmetric_damping': resisting(lambda t, d, v, B_a: B_a * abs(v)),
    'quadratic_damping': resisting(lambda t, d, v, B_2: B_2 * v * abs(v)),
    'contact_offset': lambda offset: {'surface': lambda t: (offset, 0.0)},
    'moving_environment': swing,
    'beating_environment': swing,
    'dead_zone': resisting(lambda t, d, v, gap: K_e * (max(d - gap, 0.0) - d)),
    'free_play': resisting(lambda t, d, v, gap, centre, beside: (
        (beside - 1.0) * B_e * v - K_e * d + (d > centre + gap / 2) * max(
            K_e * (d - centre - gap / 2) + (1.0 - beside) * B_e * v, 0.0))),
    'bilinear_stiffness': resisting(lambda t, d, v, K_2, depth: K_2 * max(d - depth, 0.0)),
    'stiffness_drift': resisting(lambda t, d, v, rate: K_e * rate * t * d),
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

RATES: dict[str, Callable[..., float]] = {
    'presliding_friction': lambda v, z, F_c, sigma: sigma * (v - abs(v) * z / F_c),
    'viscoelastic_relaxation': lambda v, s, K_1, tau: K_1 * v - s / tau,
    'bouc_wen_hysteresis': lambda v, z, alpha, beta, gamma: (
        v - beta * abs(v) * z - gamma * v * abs(z)),
}
TRANSFORMED = {'fractional_relaxation'}
LAGGING, RESONANT, JOINTED = {'actuator_lag'}, {'environment_resonance'}, {'joint_flexibility'}
FLOWING = {'viscous_flow'}
# Facts about them: test_effect_laws.py
NOT_SMOOTH = {'adhesion', 'backlash', 'dmt_adhesion', 'impact_damping', 'plastic_set',
              'unloading_hysteresis'}


@lru_cache(maxsize=None)
def positions(name: str, integration_rate: float = 5e3, **values: Any) -> Any:
    """Simulate with an effect, or without where the name is empty, once; (N,) [m]."""
    make = partial(with_effect, name) if name else plant_with
    world = make(integration_rate=integration_rate, **values)
    return np.array([truth.position for truth in simulate(len(T), world)])


def test_every_effect_is_compared() -> None:
    compared = {*INDEPENDENT, *RATES, *TRANSFORMED, *LAGGING, *RESONANT, *JOINTED, *FLOWING,
                *NOT_SMOOTH}
    assert {n for n, cls in EFFECTS.items() if cls.port != 'force_sensor'} == compared


def test_world_is_that_of_an_independent_integration() -> None:
    for name in INDEPENDENT:
        independent = {'law': spring_damper, **INDEPENDENT[name](*example_values(name))}
        expected = solve_contact(T, **independent)
        np.testing.assert_allclose(positions(name), expected, atol=2e-7, rtol=0.0, err_msg=name)
        assert np.max(np.abs(expected - positions(''))) > 1e-5, name


@pytest.mark.slow
@pytest.mark.parametrize('name', RATES)
def test_world_with_a_state_is_that_of_an_independent_integration(name: str) -> None:
    values = example_values(name)
    weight = values[0] if name == 'bouc_wen_hysteresis' else 1.0

    def rates(t: float, s: list[float]) -> list[float]:
        resistance = K_e * s[0] + B_e * s[1] + weight * s[2]
        return [s[1], (control(t, s[0], s[1]) - resistance) / M_t, RATES[name](*s[1:], *values)]

    expected = solve_ivp(rates, (0.0, T[-1]), [START, 0.0, 0.0], t_eval=T, max_step=2e-3, **SMOOTH)
    got = positions(name, environment__unilateral=False)
    np.testing.assert_allclose(got, expected.y[0], atol=1e-8)


def test_world_with_slow_drives_is_that_of_an_independent_integration() -> None:
    tau, = example_values('actuator_lag')

    def rates(t: float, s: list[float]) -> list[float]:
        acceleration = (s[2] - K_e * s[0] - B_e * s[1]) / M_t
        return [s[1], acceleration, (control(t, s[0], s[1]) - s[2]) / tau]

    begin = [START, 0.0, control(0.0, START, 0.0)]
    expected = solve_ivp(rates, (0.0, T[-1]), begin, t_eval=T, max_step=2e-3, **SMOOTH)
    got = positions('actuator_lag', environment__unilateral=False)
    np.testing.assert_allclose(got, expected.y[0], atol=1e-8)
    assert np.max(np.abs(got - positions('', environment__unilateral=False))) > 1e-4


def test_world_that_flows_is_that_of_an_independent_integration() -> None:
    rate, = example_values('viscous_flow')

    def rates(t: float, s: list[float]) -> list[float]:
        x, v, u = s
        flow = rate * max(x - u, 0.0)
        return [v, (control(t, x, v) - K_e * (x - u) - B_e * (v - flow)) / M_t, flow]

    expected = solve_ivp(
        rates, (0.0, T[-1]), [START, 0.0, 0.0], t_eval=T, max_step=2e-3, **SMOOTH)
    got = positions('viscous_flow', environment__unilateral=False)
    np.testing.assert_allclose(got, expected.y[0], atol=1e-8)
    assert np.max(np.abs(got - positions('', environment__unilateral=False))) > 1e-4


def test_world_with_a_resonance_is_that_of_an_independent_integration() -> None:
    mass, frequency, ratio = example_values('environment_resonance')
    k, c = mass * (2.0 * np.pi * frequency)**2, 2.0 * ratio * mass * 2.0 * np.pi * frequency

    def rates(t: float, s: list[float]) -> list[float]:
        x, v, y, w = s
        pull = k * (x - y) + c * (v - w)  # of spring and damper on the mass behind the surface
        acceleration = (control(t, x, v) - K_e * x - B_e * v - pull) / M_t
        return [v, acceleration, w, pull / mass]

    begin = [START, 0.0, START, 0.0]
    expected = solve_ivp(rates, (0.0, T[-1]), begin, t_eval=T, max_step=2e-3, **SMOOTH)
    got = positions('environment_resonance', environment__unilateral=False)
    np.testing.assert_allclose(got, expected.y[0], atol=1e-8)
    assert np.max(np.abs(got - positions('', environment__unilateral=False))) > 1e-4


def test_world_with_a_joint_is_that_of_an_independent_integration() -> None:
    compliance, share, ratio = example_values('joint_flexibility')
    m, c = share * M_t, 2.0 * ratio * np.sqrt(share * M_t / compliance)

    def rates(t: float, s: list[float]) -> list[float]:
        x, v, y, w = s
        f = (x - y) / compliance + c * (v - w)
        return [v, (control(t, x, v) - f) / (M_t - m), w, (f - K_e * y - B_e * w) / m]

    begin = [START, 0.0, START, 0.0]
    expected = solve_ivp(rates, (0.0, T[-1]), begin, t_eval=T, max_step=2e-3, **SMOOTH)
    got = positions('joint_flexibility', environment__unilateral=False)
    np.testing.assert_allclose(got, expected.y[0], atol=1e-8)
    assert np.max(np.abs(got - positions('', environment__unilateral=False))) > 1e-4


def inverse_laplace(transform: Callable[[Any], Any], t: float, nodes: int = 40) -> float:
    """Invert on Talbot's contour (Abate and Valko 2004)."""
    radius = 0.4 * nodes / t
    angle = np.pi * np.arange(1, nodes) / nodes
    cot = 1.0 / np.tan(angle)
    s, turn = radius * angle * (cot + 1j), 1.0 + 1j * (angle + (angle * cot - 1.0) * cot)
    rest = np.sum((np.exp(t * s) * transform(s) * turn).real)
    return float(radius / nodes * (0.5 * np.exp(radius * t) * transform(radius) + rest))


def test_world_with_a_fractional_derivative_is_that_of_its_laplace_transform() -> None:
    C, alpha = example_values('fractional_relaxation')

    def moved(s: Any) -> Any:
        pull = (M_t * s**2 + B_t * s + K_t) * 0.012 * (1.0 / s - s / (s**2 + 81.0))
        rest = (B_t + B_e) * s + K_t + K_e + C * s**alpha
        return (pull - K_e * START / s) / (M_t * s**2 + rest)

    got = positions('fractional_relaxation', environment__unilateral=False)
    expected = [START + inverse_laplace(moved, t) for t in T[5:].tolist()]
    np.testing.assert_allclose(got[5:], expected, atol=1e-7)


@pytest.mark.slow
def test_two_integration_steps_a_sample_are_enough() -> None:
    for name in {c.family: n for n, c in EFFECTS.items()}.values():
        coarse, fine = (positions(name, integration_rate=rate) for rate in (1e3, 5e3))
        swing = np.max(fine) - np.min(fine)
        assert np.sqrt(np.mean((coarse - fine) ** 2)) < 1e-3 * swing, name
