# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Innovations, candidates and credible laws of a diagnosis."""

from typing import Any

from concealed_worlds import ATTACHED, nominal, physics, prepared_from, recorded
from contact_estimation.diagnosis.fit.candidates import candidates_in, is_credible, untried
from contact_estimation.diagnosis.fit.fitting import Fit, fit
from contact_estimation.diagnosis.observe.model import Model
from contact_estimation.diagnosis.observe.observer import (
    innovations, kalman_filter, run, run_from, run_velocity)
from contact_estimation.diagnosis.observe.prepared_recording import PreparedRecording
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.effect import Need
from contact_estimation.physics.numeric import discretise
from contact_estimation.plant.plant_parameters import PlantParameters
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.linalg import solve_discrete_are
from scipy.signal import lsim

Array = NDArray[np.float64]

H, CUTOFF = 0.004, 50.0
T = H * np.arange(1200)
SYSTEMS = [(12.0, 350.0, 2500.0), (2.0, 1.5, 5000.0), (50.0, 1000.0, 5000.0), (3.0, 0.0, 0.0)]
EVERY = pytest.mark.parametrize('M, B, K', SYSTEMS)
PUSH = 40.0 * np.sin(9.0 * T) + 15.0 * np.sin(31.0 * T)


def matrix(M: float, B: float, K: float) -> Array:
    """Give the continuous system matrix of position and velocity."""
    return np.array([[0.0, 1.0], [-K / M, -B / M]])


@EVERY
def test_run_is_that_of_lsim(M: float, B: float, K: float) -> None:
    plant = (matrix(M, B, K), [[0.0], [1.0 / M]], np.eye(2), np.zeros((2, 1)))
    _, states, _ = lsim(plant, PUSH, T, interp=True)
    system = discretise(M, B, K, H)
    for got, expected in zip((run, run_velocity), states.T):
        np.testing.assert_allclose(got(system, PUSH, 0.0, K), expected,
                                   atol=1e-8 * np.max(np.abs(expected)))
    for continued, expected in zip(run_from(system, PUSH[500:], states[500]), states[500:].T):
        np.testing.assert_allclose(continued, expected, atol=1e-8 * np.max(np.abs(expected)))


def test_innovations_of_a_right_model_are_white_and_no_larger_than_the_noise() -> None:
    system, noise = discretise(*SYSTEMS[0], H), 3e-6
    measured = noise * np.random.default_rng(1).standard_normal(20000)
    left = innovations(measured, system, CUTOFF, H)
    assert np.std(left) == pytest.approx(noise, rel=0.15)
    for lag in range(1, 8):
        assert abs(np.corrcoef(left[lag:], left[:-lag])[0, 1]) < 0.2


@EVERY
@pytest.mark.parametrize('force_noise, position_noise', [(0.3, 1e-6), (0.01, 3e-6)])
def test_kalman_filter_is_that_of_the_riccati_equation(
    M: float, B: float, K: float, force_noise: float, position_noise: float
) -> None:
    system = discretise(M, B, K, H)
    denominator, std = kalman_filter(system, force_noise, position_noise)
    # The difference equation as a state space: y = b_0 f + z_1, z' = shift z - a y + b f.
    A = np.array([[-system.denominator[1], 1.0], [-system.denominator[2], 0.0]])
    b = system.position
    G = (b[1:] - system.denominator[1:] * b[0])[:, None] * force_noise
    cross, C = G * b[0] * force_noise, np.array([[1.0, 0.0]])
    R = np.array([[position_noise**2 + (b[0] * force_noise) ** 2]])
    scale = 1.0 / R[0, 0]  # or the solver sees rounding alone
    P = solve_discrete_are(A.T, C.T, G @ G.T * scale, R * scale, s=cross * scale) / scale
    S = (C @ P @ C.T + R)[0, 0]
    gain = (A @ P @ C.T + cross) / S
    np.testing.assert_allclose(denominator, np.poly(A - gain @ C), atol=1e-5)
    assert std == pytest.approx(np.sqrt(S), rel=1e-4)


TO_AND_FRO = 0.01 * np.sin(3.0 * np.arange(2000) / 250.0)


def without_robot(
    x: np.ndarray, model: PlantParameters | None = None
) -> tuple[PreparedRecording, Model]:
    """Prepare a motion without a reference, and the force of a spring."""
    t = np.arange(len(x)) / 250.0
    force = -5000.0 * x + np.random.default_rng(4).normal(0.0, 0.05, len(t))
    return prepared_from(Signals(t, force, t, x, t[:0], np.empty((4, 0))), model)


def candidates(x: np.ndarray, **changes: Any) -> set[str]:
    """List the effects that may be added to a permanently attached wall."""
    recording, model = without_robot(x, nominal(**{**ATTACHED, **changes}))
    return set(candidates_in([recording], model))


def test_attached_wall_has_no_effects_of_touching_and_one_inertia() -> None:
    names = candidates(TO_AND_FRO)
    assert names - candidates(TO_AND_FRO, environment__stiffness=0.0) == {
        'beating_environment', 'bouc_wen_hysteresis', 'fractional_relaxation', 'free_play',
        'moving_environment', 'stiffness_drift', 'viscoelastic_relaxation'}
    assert 'environment_inertia' not in names
    assert not any(Need.TOUCH in EFFECTS[name].needs for name in names)
    assert {'cubic_stiffness', 'force_bias'} <= names


def test_families_that_are_not_tried_are_told_with_the_reason() -> None:
    x = 0.01 * np.interp(np.arange(2000), [0, 1200, 2000], [0.0, 1.0, 1.0])
    recording, model = without_robot(x, nominal(**ATTACHED))
    told = dict(untried([recording], model))
    assert told['friction'] == 'needs a motion that returns'
    assert told['adhesion'] == 'needs a contact that begins and ends'
    assert told['robot'] == 'needs the reference trajectory of a robot'
    tried = {EFFECTS[name].family for name in candidates_in([recording], model)}
    assert not tried & set(told)
    assert tried | set(told) == {cls.family for cls in EFFECTS.values()}


SPRING = nominal(environment__stiffness=1000.0, environment__damping=20.0,
                 environment__unilateral=False)
TIMES = np.arange(3000) / 200.0
THERE_AND_BACK = 0.005 * np.sin(1.9 * TIMES) + 0.004 * np.sin(4.4 * TIMES)


def specimen(x: Array, stray: Array | float) -> Signals:
    """Record an attached specimen whose force also strays [N]."""
    force = 1000.0 * x + 5.0 * np.gradient(x, TIMES) + stray
    noise = np.random.default_rng(4).normal(0.0, 0.01, len(TIMES))
    return Signals(TIMES, noise - force, TIMES, x, np.empty(0), np.empty((4, 0)))


def prepared(signals: Signals) -> tuple[PreparedRecording, Fit]:
    """Recalibrate the spring."""
    recording, model = prepared_from(signals, SPRING)
    return recording, fit([recording], model)


@pytest.mark.parametrize('frequency, credible', [
    (0.06, False), (0.07, True), (24.0, True), (26.0, False)])
def test_a_resonance_needs_one_period_and_eight_samples_in_it(
    frequency: float, credible: bool
) -> None:
    recording, found = prepared(specimen(THERE_AND_BACK, 0.0))
    model = found.model.with_effect('environment_resonance', (0.1, frequency, 0.05))
    assert is_credible([recording], model) is credible
    further = model.with_effect('cubic_stiffness', (1e6,))  # which was fitted beside it later
    assert is_credible([recording], further) is credible


@pytest.mark.parametrize('name, values, clips', [
    ('force_saturation', (25.0,), True), ('bilinear_stiffness', (-4500.0, 0.003), False)])
def test_a_saturating_sensor_leaves_the_force_level_and_a_soft_wall_does_not(
    name: str, values: tuple[float, ...], clips: bool
) -> None:
    recording, model = prepared_from(recorded(**physics(name, *values)))
    base = fit([recording], model)
    found = fit([recording], base.model.with_effect('force_saturation', (25.0,)))
    assert is_credible([recording], found.model) is clips
