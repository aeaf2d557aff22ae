# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Linear filters along a signal, at rest at first."""

from __future__ import annotations

from typing import Sequence

import numpy as np
from scipy.signal import bilinear, lfilter

from .law import Array


def filtered(
    values: Array, dt: float, numerator: Sequence[float], denominator: Sequence[float],
    origin: float = 0.0,
) -> Array:
    """
    Filter a signal by a transfer function of s, discretised by the trapezoidal rule.

    values (N,): signal
    dt: sample period [s]
    numerator, denominator: coefficients of the powers of s, highest first
    origin: value of the signal before the first sample, at which the filter rests
    Returns values (N,): filtered signal
    """
    b, a = bilinear(numerator, denominator, 1.0 / dt)
    rest = origin * numerator[-1] / denominator[-1]
    return np.asarray(lfilter(b, a, values - origin)) + rest
