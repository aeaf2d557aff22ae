# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Robust statistics of signals, for the checks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LOADED = 4.0  # standard deviations


def loaded_correlation(x: Array, force: Array, noise: float) -> float:
    """
    Return the correlation of force and position over the positions at which there is a force.

    Free flight before a contact would hide it.

    Parameters
    ----------
    x, force : ndarray, shape (N,)
        Position [m] and force [N].
    noise : float
        Standard deviation of the force [N].

    """
    away = np.abs(force - np.mean(force[:max(1, len(force) // 10)]))
    loaded = away > _LOADED * noise
    if not loaded.any():
        return 0.0
    near = (x >= x[loaded].min()) & (x <= x[loaded].max())
    return correlation(x[near], force[near])


def spread_of(values: Array) -> float:
    """
    Return the range of values without their outermost 2 %.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Any unit, N > 0.

    """
    low, high = extremes(values)
    return high - low


def median_of(values: Array) -> float:
    """
    Return the middle value, the upper one of two; several times as fast as np.median.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Any unit, N > 0.

    """
    middle = len(values) // 2
    return float(np.partition(values, middle)[middle])


def extremes(values: Array) -> tuple[float, float]:
    """
    Return the least and the greatest value without the outermost 2 %.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Any unit, N > 0.

    """
    out = int(0.02 * len(values))
    ordered = np.sort(values)  # several times as fast as np.quantile
    return float(ordered[out]), float(ordered[len(values) - 1 - out])


def correlation(a: Array, b: Array) -> float:
    """
    Return the correlation of two signals; 0 where one is constant.

    Parameters
    ----------
    a, b : ndarray, shape (N,)
        Any units.

    """
    a, b = a - np.mean(a), b - np.mean(b)
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0.0 else 0.0
