# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The low-pass filter of all signals, and smoothed rates for accelerations."""

from math import pi, sqrt, tan
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from ..exceptions import ParameterRangeError


Row = Sequence[float]
LOWEST_CUTOFF = 1e-6  # of the sample rate


class ButterworthBank:
    """
    The same causal second-order Butterworth low-pass on several channels.

    A relation y = phi^T theta that holds at every instant also holds between its filtered sides,
    whatever the spacing of the samples, as long as one and the same filter acts on all columns.

    cutoff_frequency: -3 dB frequency [Hz]; 0: no filter
    sample_rate: nominal sampling frequency [Hz]
    """

    def __init__(self, channels: int, cutoff_frequency: float, sample_rate: float) -> None:
        check_cutoff(cutoff_frequency, sample_rate)
        self._b0, self._a1, self._a2 = 1.0, 0.0, 0.0
        self._passes = cutoff_frequency == 0.0
        if not self._passes:
            self._design(tan(pi * cutoff_frequency / sample_rate))
        self._channels = range(channels)
        self.reset()

    def _design(self, w: float) -> None:
        """
        Set the coefficients: the bilinear form of w^2 / (s^2 + sqrt(2) w s + w^2).

        Written out, because scipy.signal takes longer to import than all else that a node imports.
        """
        whole = 1.0 + sqrt(2.0) * w + w * w
        # The numerator is b0 (1, 2, 1): the double zero at the Nyquist frequency.
        self._b0 = w * w / whole
        self._a1 = 2.0 * (w * w - 1.0) / whole
        self._a2 = (1.0 - sqrt(2.0) * w + w * w) / whole

    def reset(self) -> None:
        """Reset the state: as if all signals had been 0 before."""
        self._s1 = [0.0 for _ in self._channels]
        self._s2 = [0.0 for _ in self._channels]

    def settle(self, row: Row) -> None:
        """Set the state as if all signals had always been as in a row."""
        if not self._passes:
            # y = x in take; the gain at 0 Hz is 1: 4 b0 = 1 + a1 + a2.
            self._s1 = [(1.0 - self._b0) * x for x in row]
            self._s2 = [(self._b0 - self._a2) * x for x in row]

    def take(self, row: Row) -> Row:
        """Filter the next row."""
        if self._passes:
            return row
        b0, a1, a2, s1, s2 = self._b0, self._a1, self._a2, self._s1, self._s2
        filtered = []
        for i, x in enumerate(row):
            x *= b0
            y = x + s1[i]
            s1[i] = x + x - a1 * y + s2[i]
            s2[i] = x - a2 * y
            filtered.append(y)
        return filtered


def check_cutoff(cutoff_frequency: float, sample_rate: float) -> None:
    """
    Check that a filter with this cut-off can be computed.

    cutoff_frequency, sample_rate: in [Hz]
    """
    lowest, highest = LOWEST_CUTOFF * sample_rate, 0.5 * sample_rate
    if cutoff_frequency != 0.0 and not lowest <= cutoff_frequency < highest:
        raise ParameterRangeError(
            f'conditioning.cutoff_frequency must be >= {lowest:g} Hz and < half of sample_rate '
            f'({highest:g} Hz), got {cutoff_frequency:g}; change it, or 0 for none'
        )


_LEAST = 5  # samples, to which a parabola is fitted


def smoothed_rate(
    values: NDArray[np.float64], period_s: float, window_s: float
) -> NDArray[np.float64]:
    """
    Return the rate of an evenly sampled signal, by parabolas through a moving window.

    The filter of Savitzky and Golay (1964): without lag, and exact for parabolas up to both ends.

    values (N,): the signal, any unit
    period_s: time between its samples, > 0 [s]
    window_s: length of the window, at least five samples [s]
    Returns rate (N,): in the unit of the signal per second; of fewer than five samples by plain
    differences, of a single one 0
    """
    from scipy.signal import savgol_filter  # slow to import, and no node needs it

    if len(values) < _LEAST:
        return np.gradient(values, period_s) if len(values) > 1 else np.zeros(len(values))
    window = min(2 * max(_LEAST // 2, round(0.5 * window_s / period_s)) + 1, (len(values) - 1) | 1)
    return np.asarray(savgol_filter(values, window, 2, deriv=1, delta=period_s))
