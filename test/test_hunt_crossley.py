# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Hunt and Crossley's law recovered from samples, against a batch fit and the spread of seeds."""

from __future__ import annotations

from typing import Any

from contact_estimation.estimators.hunt_crossley import HuntCrossley, HuntCrossleyParameters
from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.pipeline.axis_pipeline import EstimationPipeline
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples, pipeline_with
from core_steps import learn
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.optimize import least_squares

K, N, CHI, T = 48_000.0, 1.5, 200_000.0, 0.002


def force_of(
    law: tuple[float, float, float], d: NDArray[np.float64], v: NDArray[np.float64]
) -> NDArray[np.float64]:
    """K d^n + chi d^n v, which cannot pull."""
    stiffness, n, chi = law
    reached = np.maximum(d, 0.0) ** n
    return np.maximum(stiffness * reached + chi * reached * v, 0.0)


def samples_of(
    law: tuple[float, float, float], noise: float = 0.0, seed: int = 0, **motion: Any
) -> list[ContactSample]:
    """Put the law under the motion of the other tests."""
    samples = contact_samples(**{'contact_s': 2.0, 'amplitude': 0.003, **motion})
    d, v = np.array([s.position for s in samples]), np.array([s.velocity for s in samples])
    force = -force_of(law, d, v) + noise * np.random.default_rng(seed).standard_normal(len(d))
    return [s._replace(force=float(f)) for s, f in zip(samples, force)]


def run(samples: list[ContactSample], **tuning: Any) -> EstimationPipeline:
    """Pass samples through a pipeline."""
    named = {f'tuning__hunt_crossley__{name}': value for name, value in tuning.items()}
    pipeline = pipeline_with(estimator='hunt_crossley', **named)
    pipeline.process(samples)
    return pipeline


def law_in(pipeline: EstimationPipeline) -> Any:
    """Give the law that the estimator holds."""
    assert isinstance(pipeline.estimator, HuntCrossley)
    return pipeline.estimator.law


def test_recursion_equals_the_batch_fit_of_the_nonlinear_law() -> None:
    d = 0.008 + 0.003 * (1.0 - np.cos(20.0 * T * np.arange(800)))
    v = 0.06 * np.sin(20.0 * T * np.arange(800))
    y = force_of((K, N, CHI), d, v) + 0.5 * np.random.default_rng(1).standard_normal(800)
    scale = np.array([K, 1.0, CHI])

    def left(theta: NDArray[np.float64]) -> NDArray[np.float64]:
        stiffness, n, chi = theta * scale
        return np.asarray(y - d**n * (stiffness + chi * v))

    fit = least_squares(left, [1.0, 1.5, 1.0], xtol=1e-12)
    batch = fit.x * scale
    spread = 0.5 * np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac))) * scale
    of = HuntCrossley(HuntCrossleyParameters(relative_walk=0.0), EnvironmentParameters(), T)
    for row in np.column_stack([y, d, v, np.ones(800), np.zeros(800)]).tolist():
        learn(of, T, row, 0.25)
    assert np.all(np.abs(np.array(of.law[:3]) - batch) < 0.5 * spread)
    np.testing.assert_allclose(of.law[3:], spread, rtol=0.1)


@pytest.mark.slow
def test_claims_are_within_a_factor_2_of_the_errors_over_20_seeds() -> None:
    errors = []
    for seed in range(20):
        law = law_in(run(samples_of((K, N, CHI), noise=0.58, seed=seed), relative_walk=0.0))
        errors.append(np.array(law[:3]) - [K, N, CHI])
    ratio = np.sqrt(np.mean(np.square(errors), axis=0)) / law[3:]
    assert np.all((ratio > 0.5) & (ratio < 2.0)), ratio
