# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Smoothing, noise and derivatives against closed forms."""

from __future__ import annotations

from math import pi

from contact_estimation.diagnosis.observe.smoothing import (
    differentiate,
    slower_by_force,
    smooth,
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


def test_derivatives_are_those_of_a_sine() -> None:
    omega = 2.0 * pi * 3.0
    got = differentiate(np.sin(omega * T), H)
    inner = slice(2, -2)
    # Errors of fourth order: (w h)^4 / 30 and (w h)^4 / 90.
    np.testing.assert_allclose(got.rate[inner], omega * np.cos(omega * T)[inner],
                               atol=1.1 * omega * (omega * H) ** 4 / 30.0)
    np.testing.assert_allclose(got.acceleration[inner], -omega**2 * np.sin(omega * T)[inner],
                               atol=1.1 * omega**2 * (omega * H) ** 4 / 90.0)


@pytest.mark.parametrize('frequency, low, high', [(0.5, 6.0, 9.0), (12.0, 30.0, 70.0)])
def test_the_force_tells_the_bandwidth_of_a_static_wall(
    frequency: float, low: float, high: float
) -> None:
    noise = 0.01 * np.random.default_rng(9).standard_normal(len(T))
    cutoff = slower_by_force(1e3 * wave(frequency) + noise, EVEN, H, 1.0, 1.0)
    assert cutoff is not None and low <= cutoff <= high
