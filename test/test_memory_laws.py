# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Fractional relaxation against its closed forms, presliding friction against its own."""

from __future__ import annotations

import math
from typing import Any

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


def times(count: int, h: float) -> Array:
    """Give times a period apart [s]."""
    return h * np.arange(count, dtype=np.float64)


def test_ramp_is_answered_by_a_power_of_time() -> None:
    for alpha in [0.05, 0.3, 0.5, 0.8, 0.95]:
        for rate in [1e4, 100.0, 1.0]:
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
