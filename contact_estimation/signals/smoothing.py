# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rates of noisy signals, smoothed: for accelerations."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

_LEAST = 5  # samples, to which a parabola is fitted


def smoothed_rate(
    values: NDArray[np.float64], period_s: float, window_s: float
) -> NDArray[np.float64]:
    """
    Return the rate of an evenly sampled signal, by parabolas through a moving window.

    The filter of Savitzky and Golay (1964): without lag, and exact for parabolas up to both ends.
    The same as `scipy.signal.savgol_filter`, which fits the ends afresh at each call and takes ten
    times as long.

    values (N,): the signal, any unit
    period_s: time between its samples, > 0 [s]
    window_s: length of the window, at least five samples [s]
    Returns rate (N,): in the unit of the signal per second; of fewer than five samples by plain
    differences, of a single one 0
    """
    if len(values) < _LEAST:
        return np.gradient(values, period_s) if len(values) > 1 else np.zeros(len(values))
    window = min(2 * max(_LEAST // 2, round(0.5 * window_s / period_s)) + 1,
                 (len(values) - 1) | 1)
    weights, half = _weights(window), window // 2
    inner = np.convolve(values, weights[half, ::-1], 'valid')
    ends = weights[:half] @ values[:window], weights[half + 1:] @ values[-window:]
    return np.concatenate([ends[0], inner, ends[1]]) / period_s


@lru_cache(maxsize=8)
def _weights(window: int) -> NDArray[np.float64]:
    """Return the weights with which samples give the rate of their parabola at each of them."""
    k = np.arange(window) - window // 2
    parabola = np.linalg.pinv(np.stack([np.ones(window), k, k * k], 1))  # (3, window)
    return np.asarray(parabola[1] + 2.0 * k[:, None] * parabola[2])
