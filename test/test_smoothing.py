# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Smoothed rates are those of scipy's filter of Savitzky and Golay."""

from __future__ import annotations

from contact_estimation.signals.smoothing import smoothed_rate
import numpy as np
import pytest
from scipy.signal import savgol_filter

T = 2e-3


@pytest.mark.parametrize('count, window_s, window', [(400, 0.04, 21), (6, 0.04, 5), (50, 0.0, 5)])
def test_rate_is_that_of_scipy(count: int, window_s: float, window: int) -> None:
    values = np.random.default_rng(3).normal(size=count)
    expected = savgol_filter(values, window, 2, deriv=1, delta=T)
    np.testing.assert_allclose(smoothed_rate(values, T, window_s), expected, atol=1e-9)
