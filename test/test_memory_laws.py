# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Fractional relaxation against its closed forms, presliding friction against its own."""

from __future__ import annotations

import math
from typing import Any

from contact_estimation.physics.exponential_stiffness import (
    ExponentialStiffness,
    ExponentialStiffnessParameters,
)
from contact_estimation.physics.fractional_relaxation import (
    FractionalRelaxation,
    FractionalRelaxationParameters,
)
from contact_estimation.physics.presliding_friction import (
    PreslidingFriction,
    PreslidingFrictionParameters,
)
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.special import gamma

Array = NDArray[np.float64]
ORDERS = pytest.mark.parametrize('alpha', [0.05, 0.3, 0.5, 0.8, 0.95])


def springpot(alpha: float, C: float = 1.0) -> FractionalRelaxation:
    """Make a springpot."""
    return FractionalRelaxation(FractionalRelaxationParameters(C, alpha))


def along(effect: Any, t: Array, d: Array, v: Array) -> Array:
    """Give the resistance of an effect along a motion in contact."""
    states = effect.states_along(t, d, v, np.ones(len(t), bool))
    return np.asarray(effect.resistance(t, d, v, states, np))


def stepped(effect: Any, h: float, rates: list[float]) -> list[float]:
    """Give the resistance after each of several steps at constant rates, as a plant steps."""
    state, found = (0.0,) * effect.states, []
    for v in rates:
        moved = [s + h * r for s, r in zip(state, effect.state_rates(0.0, 1.0, v, True, state))]
        before = effect.resistance(0.0, 1.0, v, moved, math)
        state = effect.settle(1.0, v, True, tuple(moved))
        assert effect.resistance(0.0, 1.0, v, state, math) == pytest.approx(before, rel=1e-9)
        found.append(before)
    return found


def times(count: int, h: float) -> Array:
    """Give times a period apart [s]."""
    return h * np.arange(count, dtype=np.float64)


@ORDERS
@pytest.mark.parametrize('rate', [1e4, 100.0, 1.0])
def test_ramp_is_answered_by_a_power_of_time(alpha: float, rate: float) -> None:
    t = times(40000, 1.0 / rate)
    got = along(springpot(alpha), t, t, np.ones(len(t)))
    expected = t ** (1.0 - alpha) / gamma(2.0 - alpha)
    use = t > 1e-3
    np.testing.assert_allclose(got[use], expected[use], rtol=5e-3)
    within = use & (t < 1e4)
    np.testing.assert_allclose(got[within], expected[within], rtol=1e-3)


@ORDERS
def test_hold_after_a_ramp_relaxes_by_a_power_of_time(alpha: float) -> None:
    t = times(50000, 0.02)
    d, v = np.minimum(t, 1.0), np.where(t < 1.0, 1.0, 0.0)
    expected = t ** (1.0 - alpha) - np.maximum(t - 1.0, 0.0) ** (1.0 - alpha)
    use = t > 2.0
    np.testing.assert_allclose(
        along(springpot(alpha), t, d, v)[use], expected[use] / gamma(2.0 - alpha), rtol=2e-3)


@ORDERS
@pytest.mark.parametrize('h', [1e-4, 2e-3, 1.0, 100.0])
def test_steps_of_any_length_are_exact(alpha: float, h: float) -> None:
    got = stepped(springpot(alpha), h, [1.0] * 50)
    t = times(51, h)[1:]
    use = t > 1e-3
    np.testing.assert_allclose(
        np.array(got)[use], (t ** (1.0 - alpha) / gamma(2.0 - alpha))[use], rtol=2e-3)


def test_displacement_before_the_recording_is_taken_as_constant() -> None:
    t = times(500, 0.01)
    d, v = np.sin(3.0 * t), 3.0 * np.cos(3.0 * t)
    np.testing.assert_allclose(
        along(springpot(0.4), t, d + 7.0, v), along(springpot(0.4), t, d, v), atol=1e-12)


def test_memory_of_a_contact_fades_while_the_tool_is_away() -> None:
    t = times(4000, 0.01)
    d = np.where(t < 10.0, 1e-3, np.where(t < 39.0, -1e-3, 0.0))
    effect = springpot(0.5, 1000.0)
    states = effect.states_along(t, d, 0.0 * t, d > 0.0)
    left = effect.resistance(t, d, 0.0 * t, states, np)[-1]
    # Out of contact d is 0: what came 1 mm in long ago has gone out again 30 s ago.
    expected = -1.0 / math.sqrt(math.pi * (t[-1] - 9.995))
    assert left == pytest.approx(expected, rel=2e-3)


def test_presliding_friction_is_exact_from_turn_to_turn() -> None:
    F_c, sigma, swing = 3.0, 2e4, 2e-3
    effect = PreslidingFriction(PreslidingFrictionParameters(F_c, sigma))
    t = times(800, 0.5 / 800)
    d, v = swing * np.sin(4.0 * np.pi * t), 4.0 * np.pi * swing * np.cos(4.0 * np.pi * t)
    got = along(effect, t, d, v)
    up = F_c * (1.0 - math.exp(-sigma * swing / F_c))
    down = -F_c + (up + F_c) * math.exp(-2.0 * sigma * swing / F_c)
    end = F_c + (down - F_c) * np.exp(-sigma * (d + swing) / F_c)
    back = -F_c + (up + F_c) * np.exp(-sigma * (swing - d) / F_c)
    rising = t > 0.375
    np.testing.assert_allclose(got[rising], end[rising], atol=2e-4)
    falling = (t > 0.125) & (t < 0.375)
    np.testing.assert_allclose(got[falling], back[falling], atol=2e-4)


def test_presliding_friction_of_a_long_step_is_that_of_short_ones() -> None:
    effect = PreslidingFriction(PreslidingFrictionParameters(3.0, 1e6))
    long, short = stepped(effect, 0.1, [0.01]), stepped(effect, 0.001, [0.01] * 100)
    assert long[-1] == pytest.approx(short[-1], rel=1e-9)


def test_friction_forgets_its_past_out_of_contact() -> None:
    effect = PreslidingFriction(PreslidingFrictionParameters(3.0, 1e4))
    assert effect.settle(-1e-3, 0.0, False, (0.0, 2.0)) == (0.0, 0.0)


def test_exponential_force_of_a_wild_guess_is_finite() -> None:
    effect = ExponentialStiffness(ExponentialStiffnessParameters(1.0, 1e-9))
    d = np.array([0.0, 0.01, 1.0])
    force = effect.resistance(0.0, d, d, (), np)
    assert np.all(np.isfinite(force)) and np.all(np.diff(force) > 0.0)


def test_exponential_force_adds_no_stiffness_at_the_surface() -> None:
    effect = ExponentialStiffness(ExponentialStiffnessParameters(2.0, 1e-3))
    force = effect.resistance(0.0, np.array([-1e-6, 1e-6]), 0.0, (), np)
    np.testing.assert_allclose(force, 2.0 * 0.5e-6 * np.ones(2), rtol=1e-3)
