# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Robust statistics of signals, for the checks; of any units, and finite for constant signals."""

from __future__ import annotations

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LOADED = 4.0  # standard deviations
_BELOW_95_PERCENT = 0.759  # mean of the lower 95 % of the squares of a normal variable


def loaded_correlation(x: Array, force: Array, noise: float) -> float:
    """Correlate force and position where there is a force: free flight before would hide it."""
    if not len(force):
        return 0.0
    away = np.abs(force - np.mean(force[:max(1, len(force) // 10)]))
    loaded = away > _LOADED * noise
    if not loaded.any():
        return 0.0
    near = (x >= x[loaded].min()) & (x <= x[loaded].max())
    return correlation(x[near], force[near])


def median_of(values: Array) -> float:
    """Return the middle value, the upper one of two; several times as fast as np.median."""
    middle = len(values) // 2
    return float(np.partition(values, middle)[middle])


def extremes(values: Array) -> tuple[float, float]:
    """Return the least and the greatest value without the outermost 2 %."""
    out = int(0.02 * len(values))
    ordered = np.sort(values)  # several times as fast as np.quantile
    return float(ordered[out]), float(ordered[len(values) - 1 - out])


def spread_of(values: Array) -> float:
    """Return the range of values without their outermost 2 %."""
    low, high = extremes(values)
    return high - low


def correlation(a: Array, b: Array) -> float:
    """Return the correlation of two signals; 0 where one is constant."""
    a, b = (_unit(one - np.mean(one)) for one in (a, b))
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0.0 else 0.0


def _unit(values: Array) -> Array:
    """Scale to at most 1, so that squares are finite and not all zero."""
    most = float(np.max(np.abs(values), initial=0.0))
    return values / most if most > 0.0 else values


def white_noise_of(values: Array, stride: int = 1) -> float:
    """
    Return the deviation of white noise by second differences, in which motion hardly shows.

    The largest are left out: an impact is no noise. Infinite where there are too few values.
    """
    if len(values) < 2 * stride + 1:
        return inf
    middle = values[stride:-stride]
    squares = np.square(values[2 * stride:] - 2.0 * middle + values[:-2 * stride])
    most = max(1, int(0.95 * len(squares)))
    lower = np.partition(squares, most - 1)[:most]
    return sqrt(float(np.mean(lower)) / (6.0 * _BELOW_95_PERCENT))
