# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The adaptive estimators of the paper, and that of a Hunt-Crossley wall."""

from typing import Any

from contact_estimation.estimators.gradient_speed import stiffest_wall
from contact_estimation.estimators.hunt_crossley import HuntCrossley, HuntCrossleyParameters
from contact_estimation.estimators.indirect_adaptive import (
    IndirectAdaptive, IndirectAdaptiveParameters)
from contact_estimation.estimators.model_following import ReferenceModel
from contact_estimation.estimators.mrac import ModelReferenceAdaptive, ModelReferenceParameters
from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.pipeline.axis_pipeline import EstimationPipeline
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import closed_loop, contact_samples, known, learn, PAPER_SENSORS, pipeline_with, Run
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.optimize import least_squares

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


K, B, T = 4800.0, 200.0, 0.002
GAINS = np.array([5.0e4, 2.5e3])


def estimator(start: tuple[float, float] = (3000.0, 50.0), **tuning: Any) -> IndirectAdaptive:
    """Make an estimator with a first guess of K and B."""
    environment = EnvironmentParameters(initial_stiffness=start[0], initial_damping=start[1])
    return IndirectAdaptive(IndirectAdaptiveParameters(**tuning), environment, T)


def theta(of: IndirectAdaptive) -> NDArray[np.float64]:
    """Stack K_hat and B_hat."""
    return np.array([of.stiffness, of.damping])


def sine_rows(
    count: int, period: float = T, K_e: float = K, B_e: float = B
) -> NDArray[np.float64]:
    """Rows (y, delta, v) of 50 N with a sine of 8 N at 20 rad/s, whatever the stiffness."""
    t = period * np.arange(count)
    d = (50.0 + 8.0 * np.sin(20.0 * t)) / K_e
    v = 160.0 * np.cos(20.0 * t) / K_e
    return np.column_stack([K_e * d + B_e * v, d, v])


def learn_all(of: IndirectAdaptive, rows: NDArray[np.float64], period: float = T) -> None:
    """Pass rows through an estimator."""
    for row in rows.tolist():
        learn(of, period, (*row, 1.0))


def test_adaptation_law_is_the_gradient_of_half_the_squared_force_error() -> None:
    def cost(at: NDArray[np.float64]) -> float:
        return 0.5 * float(phi @ at - 50.0) ** 2

    phi, start, dt = np.array([0.012, 0.07]), np.array([3000.0, 50.0]), 1e-7
    steps = np.diag([1e-2, 1e-2])
    gradient = np.array([(cost(start + h) - cost(start - h)) / 2e-2 for h in steps])
    adaptive = estimator()
    learn(adaptive, dt, (50.0, *phi.tolist(), 1.0))
    np.testing.assert_allclose((theta(adaptive) - start) / dt, -GAINS * gradient, rtol=1e-4)


@pytest.mark.parametrize('amplitude', [1e-3, 1e-2, 1.0])
def test_lyapunov_function_falls_in_every_noise_free_step(amplitude: float) -> None:
    random, adaptive, values = np.random.default_rng(5), estimator(), []
    for d, v in random.normal(0.0, amplitude, (500, 2)).tolist():
        error = theta(adaptive) - [K, B]
        values.append(error @ (error / GAINS))
        learn(adaptive, T, (K * d + B * v, d, v, 1.0))
    assert np.all(np.diff(values) <= 1e-12 * values[0])


def test_normalised_finds_a_stiff_wall_where_fixed_gains_starve() -> None:
    fixed, normalised = estimator(), estimator(normalised=True)
    for adaptive in (fixed, normalised):
        learn_all(adaptive, sine_rows(1500, T, 1e5, 200.0))
    assert fixed.stiffness < 0.2e5
    np.testing.assert_allclose(theta(normalised), [1e5, 200.0], rtol=0.01)


@pytest.mark.parametrize('normalised', [False, True])
def test_claimed_std_is_the_spread_over_noise(normalised: bool) -> None:
    period, sigma, runs = 0.01, 1.0, 250
    random, rows, finals = np.random.default_rng(6), sine_rows(400, 0.01), []
    for _ in range(runs):
        adaptive = estimator((K, B), normalised=normalised, adaptation_rate=5.0)
        noisy = rows[:, 0] + sigma * random.standard_normal(len(rows))
        for y, (_, d, v) in zip(noisy.tolist(), rows.tolist()):
            learn(adaptive, period, (y, d, v, 1.0), sigma**2)
        finals.append(theta(adaptive))
    claimed = known(adaptive)[2:4]
    np.testing.assert_allclose(np.std(finals, axis=0), claimed, rtol=0.15)


def test_the_stiffest_wall_is_adapted_to_within_two_seconds_under_50_n() -> None:
    gain, T = 5e4, 1e-4
    K, d, estimate = stiffest_wall(gain), 50.0 / stiffest_wall(gain), 0.0
    for _ in range(round(2.0 / T)):
        estimate -= T * gain * d * (estimate * d - K * d)  # eq. (25)
    assert estimate / K == pytest.approx(1.0 - np.exp(-1.0), rel=1e-3)


def test_normalised_gains_never_starve() -> None:
    tuning = {'tuning__indirect_adaptive__normalised': True}
    pipeline = pipeline_with(estimator='indirect_adaptive', **tuning)
    assert pipeline.limitation == ''


def test_the_paper_s_gains_state_their_limit_and_the_default_has_none() -> None:
    limited = pipeline_with(estimator='indirect_adaptive').limitation
    assert '1.58e+04 N/m' in limited and 'normalised' in limited
    assert pipeline_with().limitation == ''


K_HC, N, CHI, T_HC = 48_000.0, 1.5, 200_000.0, 0.002


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
    d = 0.008 + 0.003 * (1.0 - np.cos(20.0 * T_HC * np.arange(800)))
    v = 0.06 * np.sin(20.0 * T_HC * np.arange(800))
    y = force_of((K_HC, N, CHI), d, v) + 0.5 * np.random.default_rng(1).standard_normal(800)
    scale = np.array([K_HC, 1.0, CHI])

    def left(theta: NDArray[np.float64]) -> NDArray[np.float64]:
        stiffness, n, chi = theta * scale
        return np.asarray(y - d**n * (stiffness + chi * v))

    fit = least_squares(left, [1.0, 1.5, 1.0], xtol=1e-12)
    batch = fit.x * scale
    spread = 0.5 * np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac))) * scale
    of = HuntCrossley(HuntCrossleyParameters(relative_walk=0.0), EnvironmentParameters(), T_HC)
    for row in np.column_stack([y, d, v, np.ones(800), np.zeros(800)]).tolist():
        learn(of, T_HC, row, 0.25)
    assert np.all(np.abs(np.array(of.law[:3]) - batch) < 0.5 * spread)
    np.testing.assert_allclose(of.law[3:], spread, rtol=0.1)


@pytest.mark.slow
def test_claims_are_within_a_factor_2_of_the_errors_over_20_seeds() -> None:
    errors = []
    for seed in range(20):
        law = law_in(run(samples_of((K_HC, N, CHI), noise=0.58, seed=seed), relative_walk=0.0))
        errors.append(np.array(law[:3]) - [K_HC, N, CHI])
    ratio = np.sqrt(np.mean(np.square(errors), axis=0)) / law[3:]
    assert np.all((ratio > 0.5) & (ratio < 2.0)), ratio
