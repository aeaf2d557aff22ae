# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The world with each effect against an independent integration by scipy with events."""

from __future__ import annotations

from functools import lru_cache, partial
from typing import Any, Callable

from contact_estimation.physics import EFFECTS
from effect_examples import example_values
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from world_reference import (
    B_e,
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


@pytest.mark.slow
def test_two_integration_steps_a_sample_are_enough() -> None:
    for name in {c.family: n for n, c in EFFECTS.items()}.values():
        coarse, fine = positions(name, integration_rate=1e3), positions(name)
        swing = np.max(fine) - np.min(fine)
        assert np.sqrt(np.mean((coarse - fine) ** 2)) < 1e-3 * swing, name
