# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Smoothed rates are those of scipy's filter of Savitzky and Golay."""

from __future__ import annotations

from contact_estimation.signals.filters import smoothed_rate
import numpy as np
import pytest
from scipy.signal import savgol_filter

T = 2e-3


@pytest.mark.parametrize('count, window_s, window', [(400, 0.04, 21), (6, 0.04, 5), (50, 0.0, 5)])
def test_rate_is_that_of_scipy(count: int, window_s: float, window: int) -> None:
    values = np.random.default_rng(3).normal(size=count)
    expected = savgol_filter(values, window, 2, deriv=1, delta=T)
    np.testing.assert_allclose(smoothed_rate(values, T, window_s), expected, atol=1e-9)


def test_rate_of_a_parabola_is_exact_up_to_its_ends() -> None:
    t = T * np.arange(100)
    np.testing.assert_allclose(smoothed_rate(3.0 * t**2 - t, T, 0.02), 6.0 * t - 1.0, atol=1e-9)


def test_rate_of_few_samples_is_their_difference() -> None:
    np.testing.assert_allclose(smoothed_rate(np.array([0.0, 1e-3]), T, 0.02), [0.5, 0.5])
    assert smoothed_rate(np.array([4.0]), T, 0.02).tolist() == [0.0]
