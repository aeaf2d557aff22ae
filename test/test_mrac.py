# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Model reference adaptive control: it drives an unknown arm, and estimates the environment."""

from __future__ import annotations

from contact_estimation.estimators.model_following import ReferenceModel
from contact_estimation.estimators.mrac import ModelReferenceAdaptive, ModelReferenceParameters
from contact_estimation.estimators.parameters import EnvironmentParameters
from core_runs import closed_loop, PAPER_SENSORS, Run
from core_steps import learn
import numpy as np
from numpy.typing import NDArray
import pytest

MOVING_S = 4.4  # the manoeuvre rests before


def model_errors(run: Run, after_s: float = MOVING_S + 2.0) -> NDArray[np.float64]:
    """Compute x - x_m [m] from what was measured and published alone."""
    model, errors = ReferenceModel(100.0, 6500.0, 1e5), []
    for before, result, truth in zip(run.results, run.results[1:], run.truths[1:]):
        assert before.reference is not None
        _, x, _, F = result.sample  # the arm rests at first, so that the model starts at rest
        motion = model.advance(0.002, x, 0.0, F, before.reference)
        errors.append(truth.position - motion.position if truth.t > after_s else 0.0)
    return np.array(errors)


@pytest.mark.slow
@pytest.mark.parametrize('mass, damping, experiment', [  # the corners of (50, 200)
    (25.0, 100.0, 'sine'), (25.0, 300.0, 'none'), (75.0, 100.0, 'none'), (75.0, 300.0, 'sine')])
def test_arm_is_within_a_fifth_of_a_millimetre_of_the_model_after_two_seconds(
    mass: float, damping: float, experiment: str
) -> None:
    run = closed_loop({'estimator': 'mrac'}, {
        **PAPER_SENSORS, 'robot.control': 'force', 'robot.mass': mass, 'robot.damping': damping,
    }, experiment, 9.6)
    assert np.max(np.abs(model_errors(run))) < 2e-4


def test_lyapunov_function_of_eq_24_never_grows_without_noise() -> None:
    t = 0.002 * np.arange(1500)
    d, v = 0.01 + 0.002 * np.sin(20.0 * t), 0.04 * np.cos(20.0 * t)
    averaging, V = ModelReferenceAdaptive(
        ModelReferenceParameters(), EnvironmentParameters(), 0.002), []
    for row in np.column_stack([4800.0 * d + 200.0 * v, d, v]).tolist():
        learn(averaging, 0.002, tuple(row))
        V.append((averaging.stiffness - 4800.0) ** 2 / 5e4 + (averaging.damping - 200.0) ** 2
                 / 2.5e3)
    assert np.max(np.diff(V)) <= 1e-9 * V[0]
    assert V[-1] < 1e-4 * V[0]
