# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Model following: an arm of unknown mass and damping does what the target impedance would."""

from __future__ import annotations

from math import exp
from typing import Any, NamedTuple

from contact_estimation.estimators.model_following import (
    ModelFollowing,
    ModelFollowingParameters,
    ReferenceModel,
)
from contact_estimation.reference.setpoints import Reference
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.integrate import odeint

M_t, B_t, K_t = 100.0, 6500.0, 1e5
K_E, B_E = 4800.0, 200.0
CORNERS = pytest.mark.parametrize('mass, damping', [(25, 100), (25, 300), (75, 100), (75, 300)])


class Path(NamedTuple):
    """A run of an arm under control: x - x_m, s, m_hat and b_hat of every sample."""

    error: NDArray[np.float64]
    filtered: NDArray[np.float64]
    mass: NDArray[np.float64]
    damping: NDArray[np.float64]


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
        x_r, v_r, a_r, _ = reference_at(t)
        return [v, a_r + (force_at(t) - B_t * (v - v_r) - K_t * (x - x_r)) / M_t]

    t = dt * np.arange(round(1.0 / dt) + 1)
    expected = odeint(rates, [0.0, 0.0], t, rtol=1e-10, atol=1e-13)[:, 0]
    model = ReferenceModel(M_t, B_t, K_t)
    positions = [
        model.advance(dt, 0.0, 0.0, force_at(now), reference_at(now)).position
        for now in t.tolist()
    ]
    return float(np.max(np.abs(positions - expected)) / np.max(np.abs(expected)))


def follow(
    mass: float, damping: float, duration: float, dt: float = 0.002, late: bool = False,
    wall: tuple[float, float] = (K_E, B_E), noise: float = 0.0, **tuning: Any,
) -> Path:
    """Move an arm into an attached wall and back at 5 and 13 rad/s, under sampled control."""
    following = ModelFollowing(ModelFollowingParameters(**tuning))
    generator = np.random.default_rng(0)
    x = v = u = 0.0
    path = []
    for k in range(round(duration / dt)):
        wiggles = [(a, w, w * k * dt) for a, w in ((0.02, 5.0), (0.004, 13.0))]
        reference = Reference(
            sum(a * np.sin(p) for a, w, p in wiggles),
            sum(a * w * np.cos(p) for a, w, p in wiggles),
            sum(-a * w * w * np.sin(p) for a, w, p in wiggles),
        )
        measured = -(wall[0] * x + wall[1] * v) + noise * generator.uniform(-1.0, 1.0)
        new = following.force(dt, x, v, measured, reference)
        motion = following.model.motion
        assert motion is not None
        s = v - motion.velocity + following._p.error_rate * (x - motion.position)
        path.append((x - motion.position, s, following.mass, following.damping))
        acting = u if late else new
        for _ in range(4):  # exact for an arm between samples but for the wall, held over a step
            h, push = 0.25 * dt, acting - (wall[0] * x + wall[1] * v)
            decay = exp(-damping * h / mass)
            x += push / damping * h + (v - push / damping) * mass / damping * (1.0 - decay)
            v = push / damping + (v - push / damping) * decay
        u = new
    return Path(*np.array(path).T)


def test_reference_model_solves_the_target_impedance() -> None:
    assert model_error(1e-4) < 1e-4


@CORNERS
def test_error_is_below_a_fifth_of_a_millimetre_after_two_seconds(
    mass: float, damping: float
) -> None:
    path = follow(mass, damping, 5.0, noise=1.0)
    assert np.max(np.abs(path.error[1000:])) < 2e-4


@CORNERS
def test_arm_is_found(mass: float, damping: float) -> None:
    path = follow(mass, damping, 5.0, noise=1.0)
    assert path.mass[-1] == pytest.approx(mass, rel=0.05)
    assert path.damping[-1] == pytest.approx(damping, rel=0.2)
