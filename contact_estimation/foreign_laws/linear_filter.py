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

    Parameters
    ----------
    values : ndarray, shape (N,)
        Signal.
    dt : float
        Sample period [s].
    numerator, denominator : sequence of float
        Coefficients of the powers of s, highest first.
    origin : float
        Value of the signal before the first sample, at which the filter rests.

    Returns
    -------
    values : ndarray, shape (N,)
        Filtered signal.

    """
    b, a = bilinear(numerator, denominator, 1.0 / dt)
    rest = origin * numerator[-1] / denominator[-1]
    return np.asarray(lfilter(b, a, values - origin)) + rest
