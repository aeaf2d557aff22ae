# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Model reference adaptive control: it drives an unknown arm, and estimates the environment."""

from __future__ import annotations

from typing import Any

from contact_estimation.estimators.model_following import ReferenceModel
from contact_estimation.estimators.mrac import ModelReferenceAdaptive, ModelReferenceParameters
from contact_estimation.estimators.parameters import EnvironmentParameters
from core_runs import closed_loop, PAPER_SENSORS, Run
from core_steps import learn
import numpy as np
from numpy.typing import NDArray
import pytest

CORNERS = [(25.0, 100.0), (25.0, 300.0), (75.0, 100.0), (75.0, 300.0)]  # of (50, 200)
MOVING_S = 4.4  # the manoeuvre rests before


def arm_run(
    arm: tuple[float, float], experiment: str = 'sine', duration: float = 9.6, **plant: Any
) -> Run:
    """Let mrac drive a bare arm of a mass and a damping into the wall and back."""
    return closed_loop({'estimator': 'mrac'}, bare(arm) | plant, experiment, duration)


def bare(arm: tuple[float, float]) -> dict[str, Any]:
    """Give the parameters of a bare arm with the paper's sensors."""
    return {**PAPER_SENSORS, 'robot.control': 'force', 'robot.mass': arm[0],
            'robot.damping': arm[1]}


def model_errors(run: Run, after_s: float = MOVING_S + 2.0) -> NDArray[np.float64]:
    """Compute x - x_m [m] from what was measured and published alone."""
    model, errors = ReferenceModel(100.0, 6500.0, 1e5), []
    for before, result, truth in zip(run.results, run.results[1:], run.truths[1:]):
        assert before.reference is not None
        _, x, _, F = result.sample  # the arm rests at first, so that the model starts at rest
        motion = model.advance(0.002, x, 0.0, F, before.reference)
        errors.append(truth.position - motion.position if truth.t > after_s else 0.0)
    return np.array(errors)


def estimator(**tuning: Any) -> ModelReferenceAdaptive:
    """Make the estimator by itself."""
    return ModelReferenceAdaptive(
        ModelReferenceParameters(**tuning), EnvironmentParameters(), 0.002
    )


def rows_of(count: int, seed: int = 0) -> list[tuple[float, float, float]]:
    """Make (F, delta, v) of an excited contact; noise of 0.5 N unless the seed is 0."""
    t = 0.002 * np.arange(count)
    d, v = 0.01 + 0.002 * np.sin(20.0 * t), 0.04 * np.cos(20.0 * t)
    noise = 0.5 * np.random.default_rng(seed).standard_normal(count) if seed else 0.0
    columns = np.column_stack([4800.0 * d + 200.0 * v + noise, d, v])
    return [(F, a, b) for F, a, b in columns.tolist()]


@pytest.mark.slow
@pytest.mark.parametrize('experiment', ['sine', 'none'])
@pytest.mark.parametrize('arm', CORNERS)
def test_arm_is_within_a_fifth_of_a_millimetre_of_the_model_after_two_seconds(
    arm: tuple[float, float], experiment: str
) -> None:
    assert np.max(np.abs(model_errors(arm_run(arm, experiment)))) < 2e-4


def test_lyapunov_function_of_eq_24_never_grows_without_noise() -> None:
    averaging, V = estimator(), []
    for row in rows_of(1500):
        learn(averaging, 0.002, row)
        V.append((averaging.stiffness - 4800.0) ** 2 / 5e4 + (averaging.damping - 200.0) ** 2
                 / 2.5e3)
    assert np.max(np.diff(V)) <= 1e-9 * V[0]
    assert V[-1] < 1e-4 * V[0]
