# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Smoothing, noise and derivatives against closed forms."""

from __future__ import annotations

from math import pi

from concealed_worlds import nominal
from contact_estimation.diagnosis.observe.observed import observe, Observed
from contact_estimation.diagnosis.observe.signals import Signals
from contact_estimation.diagnosis.observe.smoothing import (
    CUTOFFS_HZ,
    differentiate,
    rate_noise,
    slower_by_force,
    smooth,
    smooth_enough,
    white_noise_std,
)
import numpy as np
from numpy.typing import NDArray
import pytest

Array = NDArray[np.float64]

H = 0.004
T = H * np.arange(2000)
EVEN = np.ones(len(T))
MIDDLE = slice(250, -250)  # whole periods of all sines below


def wave(frequency: float) -> Array:
    """Give a sine of 5 mm."""
    return np.asarray(5e-3 * np.sin(2.0 * pi * frequency * T))


@pytest.mark.parametrize('std, quantum', [(3e-6, 0.0), (3e-6, 1e-6), (1e-6, 3e-6)])
def test_noise_std_is_known_under_a_slow_signal(std: float, quantum: float) -> None:
    generator = np.random.default_rng(1)
    signal = wave(3.0) + std * generator.standard_normal(len(T))
    if quantum > 0.0:
        signal = np.round(signal / quantum) * quantum
    # What rounding adds is white and even over a step (Widrow 1956).
    expected = np.sqrt(std**2 + quantum**2 / 12.0)
    assert white_noise_std(signal) == pytest.approx(expected, rel=0.1)


def test_noise_std_scales_with_the_signal() -> None:
    noise = np.random.default_rng(2).standard_normal(len(T))
    assert white_noise_std(7.0 * noise) == pytest.approx(7.0 * white_noise_std(noise))


def test_few_impacts_do_not_count_as_noise() -> None:
    noise = np.random.default_rng(3).standard_normal(8000)
    noise[[700, 5300]] += 500.0
    assert white_noise_std(noise) == pytest.approx(1.0, rel=0.15)


@pytest.mark.parametrize('signal', [np.zeros(2000), np.full(2000, 3.5), 0.02 * T])
def test_what_has_no_noise_has_none(signal: Array) -> None:
    assert white_noise_std(signal) < 1e-12


def test_smoothing_shifts_no_phase() -> None:
    slow = wave(2.0)
    smoothed = smooth(slow, EVEN, 20.0 * H)
    quadrature = np.cos(2.0 * pi * 2.0 * T)[MIDDLE]
    assert abs(quadrature @ smoothed[MIDDLE]) < 1e-4 * abs(quadrature @ quadrature) * 5e-3


def test_smoothing_of_a_mirrored_signal_is_mirrored() -> None:
    signal = np.random.default_rng(4).standard_normal(500)
    there = smooth(signal, np.ones(500), 0.05)
    np.testing.assert_allclose(smooth(signal[::-1], np.ones(500), 0.05)[::-1], there, atol=1e-9)


def test_cut_off_halves_the_amplitude() -> None:
    smoothed = smooth(wave(10.0), EVEN, 10.0 * H)
    shape = np.sin(2.0 * pi * 10.0 * T)[MIDDLE]
    gain = (shape @ smoothed[MIDDLE]) / (shape @ shape) / 5e-3
    # |1 - exp(i w)|^6 in place of w^6: the third difference of a sampled sine.
    exact = 1.0 / (1.0 + (2.0 * np.sin(pi * 10.0 * H) / (2.0 * pi * 10.0 * H)) ** 6)
    assert gain == pytest.approx(exact, rel=1e-4)
    assert gain == pytest.approx(0.5, abs=0.01)


def test_smoothing_solves_the_normal_equations() -> None:
    generator = np.random.default_rng(5)
    signal, weight = generator.standard_normal(40), generator.uniform(0.1, 1.0, 40)
    third = np.diff(np.eye(40), 3, axis=0)
    matrix = np.diag(weight) + (2.0 * pi * 0.1) ** -6 * third.T @ third
    expected = np.linalg.solve(matrix, weight * signal)
    np.testing.assert_allclose(smooth(signal, weight, 0.1), expected, atol=1e-9)


def test_smoothing_leaves_a_parabola_alone() -> None:
    parabola = 0.3 - 0.02 * T + 0.01 * T**2
    np.testing.assert_allclose(smooth(parabola, EVEN, 10.0 * H), parabola, atol=1e-7)


def test_samples_that_were_filled_in_hardly_count() -> None:
    signal, weight = wave(2.0), EVEN.copy()
    wrong = signal.copy()
    wrong[1000:1005] += 1e-3
    weight[1000:1005] = 1e-3
    assert np.max(np.abs(smooth(wrong, weight, 20.0 * H) - signal)) < 0.03e-3


def test_derivatives_are_those_of_a_sine() -> None:
    omega = 2.0 * pi * 3.0
    got = differentiate(np.sin(omega * T), H)
    inner = slice(2, -2)
    # Errors of fourth order: (w h)^4 / 30 and (w h)^4 / 90.
    np.testing.assert_allclose(got.rate[inner], omega * np.cos(omega * T)[inner],
                               atol=1.1 * omega * (omega * H) ** 4 / 30.0)
    np.testing.assert_allclose(got.acceleration[inner], -omega**2 * np.sin(omega * T)[inner],
                               atol=1.1 * omega**2 * (omega * H) ** 4 / 90.0)


def test_derivatives_of_a_quartic_are_exact() -> None:
    t = np.linspace(0.0, 2.9, 30)
    got = differentiate(t**4, 0.1)
    np.testing.assert_allclose(got.rate[2:-2], 4.0 * t[2:-2] ** 3, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(got.acceleration[2:-2], 12.0 * t[2:-2] ** 2, rtol=1e-9, atol=1e-9)


def test_derivatives_keep_the_signal() -> None:
    signal = wave(3.0)
    np.testing.assert_array_equal(differentiate(signal, H).value, signal)


@pytest.mark.parametrize('frequency, low, high', [(0.5, 6.0, 9.0), (12.0, 30.0, 70.0)])
def test_cut_off_follows_the_signal(frequency: float, low: float, high: float) -> None:
    noise = 3e-6
    signal = wave(frequency) + noise * np.random.default_rng(6).standard_normal(len(T))
    smoothed, cutoff = smooth_enough(signal, EVEN, H, noise)
    assert low <= cutoff <= high
    assert np.std((smoothed - wave(frequency))[MIDDLE]) < noise


def test_more_noise_needs_no_more_bandwidth() -> None:
    noise = np.random.default_rng(7).standard_normal(len(T))
    loud, quiet = (smooth_enough(wave(3.0) + s * noise, EVEN, H, s)[1] for s in (1e-4, 1e-6))
    assert loud <= quiet
    assert {loud, quiet} <= set(CUTOFFS_HZ)


def test_slow_sampling_leaves_the_signal_as_it_is() -> None:
    signal = wave(3.0)
    smoothed, _ = smooth_enough(signal, EVEN, 0.1, 1e-6)
    np.testing.assert_array_equal(smoothed, signal)


@pytest.mark.parametrize('cutoff', [6.0, 20.0, 70.0])
def test_rate_noise_bounds_that_of_smoothed_noise(cutoff: float) -> None:
    noise = 1e-5 * np.random.default_rng(8).standard_normal(len(T))
    rate = differentiate(smooth(noise, EVEN, cutoff * H), H).rate
    assert 0.4 < np.std(rate) / rate_noise(1e-5, cutoff, H) < 1.0


@pytest.mark.parametrize('frequency, low, high', [(0.5, 6.0, 9.0), (12.0, 30.0, 70.0)])
def test_the_force_tells_the_bandwidth_of_a_static_wall(
    frequency: float, low: float, high: float
) -> None:
    noise = 0.01 * np.random.default_rng(9).standard_normal(len(T))
    cutoff = slower_by_force(1e3 * wave(frequency) + noise, EVEN, H, 1.0, 1.0)
    assert cutoff is not None and low <= cutoff <= high


def test_the_force_tells_no_bandwidth_where_noise_of_the_motion_matters_little() -> None:
    noise = 0.01 * np.random.default_rng(9).standard_normal(len(T))
    assert slower_by_force(1e3 * wave(0.5) + noise, EVEN, H, 0.05, 1.0) is None


def wobbling(damping: float) -> Observed:
    """Observe a damper in a slow sine whose position sensor wobbles at 40 Hz."""
    motion, generator = wave(0.25), np.random.default_rng(10)
    wobble = 4e-5 * np.sin(2.0 * pi * 40.0 * T) + 1e-5 * generator.standard_normal(len(T))
    force = np.asarray(-damping * np.gradient(motion, H), np.float64)
    force += 0.01 * generator.standard_normal(len(T))
    t = np.asarray(T, np.float64)
    signals = Signals(t, force, t, motion + wobble, np.empty(0), np.empty((4, 0)))
    return observe(signals, nominal(
        environment__stiffness=0.0, environment__damping=damping, environment__unilateral=False))


def test_a_wobble_that_the_force_of_a_damper_lacks_is_no_speed() -> None:
    speed = np.gradient(wave(0.25), H)
    loud, quiet = wobbling(5000.0), wobbling(1.0)
    assert np.std((loud.v - speed)[MIDDLE]) < 0.1 * np.std((quiet.v - speed)[MIDDLE])
    assert loud.position_noise == pytest.approx(4e-5 / np.sqrt(2.0), rel=0.1)


def pulled(damping: float) -> Observed:
    """Observe a metal that yields at one speed, with positions rounded to six samples' way."""
    t = np.asarray(0.1 * np.arange(3000), np.float64)
    force = -150.0 * np.tanh(t / 5.0) - 0.1 * t
    force += 0.2 * np.random.default_rng(12).standard_normal(len(t))
    x = np.round(1.5e-5 * t, 5)
    signals = Signals(t, np.asarray(force), t, x, np.empty(0), np.empty((4, 0)))
    return observe(signals, nominal(
        environment__stiffness=3e4, environment__damping=damping, environment__unilateral=False))


def test_a_steady_speed_is_resolved_where_its_noise_would_hide_every_misfit() -> None:
    resolved, unresolved = pulled(1e7), pulled(1.0)
    assert resolved.v[100:-100] == pytest.approx(1.5e-5, rel=0.05)
    assert resolved.motion_error is not None and unresolved.motion_error is not None
    assert np.median(resolved.motion_error[1]) < 0.05 * 1.5e-5
    assert np.median(unresolved.motion_error[1]) > 0.2 * 1.5e-5
