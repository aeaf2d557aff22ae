# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Forces that no contact can have caused are replaced before the filter spreads them."""

from __future__ import annotations

from math import exp, sqrt
_MEMORY = 0.9  # of the line per sample
_STIFFEST = 1e6  # standard deviation of the slope of a new line [N/m]
_BEND = 0.2  # of the force, by which damping may bend the line at a reversal
_SUPPORT = 10  # samples in agreement, below which the line may be wrong: touch-down bends it
_SCALE_RATE = 0.05  # of the logarithm of the noise per sample
_JUMP = sqrt(6.0)  # noise of a second difference
_WITHIN = 0.683  # share of Gaussian noise within one standard deviation
_LARGER, _SMALLER = exp(_SCALE_RATE * _WITHIN), exp(_SCALE_RATE * (_WITHIN - 1.0))


class OutlierGate:
    """
    Replaces forces that are far from the line of the last samples by the line.

    A force is an outlier where it also jumps away from its course in time: where a tool with a
    fast touch turns around, damping leaves the line of force against depth within a few samples.

    The line of force against depth is fitted to the last ten samples or so by recursive least
    squares, so that it holds for any smooth law and wherever the surface is. The noise is a
    quantile of its errors, on which outliers have no leverage. The way out: after a number of
    outliers in a row on the same side, the line starts afresh from the last of them.
    """

    def __init__(self, threshold: float, samples: int) -> None:
        self.count = 0
        self._scale = 0.0
        self._forget()
        self.configure(threshold, samples)

    def configure(self, threshold: float, samples: int) -> None:
        """Set other thresholds; see the constructor."""
        self._threshold, self._samples = threshold, samples
        self.leave()

    def leave(self) -> None:
        """Forget the line, as out of contact; the noise stays."""
        if self._line is not None:
            self._forget()

    def _forget(self) -> None:
        # Depth, force there, slope; covariance of force and slope, times the noise variance.
        self._line: tuple[float, float, float, float, float, float] | None = None
        self._course = 0.0, 0.0  # the last two forces, outliers replaced
        self._run = 0  # outliers in a row, negative below the line
        self._support = 0  # samples that agree with the line

    def replace(self, d: float, y: float, noise_std: float) -> float:
        """
        Replace the force of the next sample in contact where it is an outlier.

        d: penetration [m]
        y: pressing force [N]
        noise_std: standard deviation of the force noise, > 0 [N]
        Returns replaced: the line instead of an outlier [N]
        """
        line = self._line
        if line is None:
            if self._threshold:
                self._start(d, y, noise_std)
            return y
        depth, level, slope, cc, ck, kk = line
        x = d - depth
        cc, ck = cc + x * (2.0 * ck + x * kk), ck + x * kk  # at this depth
        predicted = level + slope * x
        error = y - predicted
        size, scale = abs(error), self._scale
        if scale < noise_std:
            scale = noise_std
        width = scale * sqrt(1.0 + cc)
        self._scale = scale * (_LARGER if size > width else _SMALLER)
        bound = self._threshold * width
        last, before = self._course
        if (size > bound and size > bound + _BEND * max(abs(predicted), abs(level))
                and abs(y - 2.0 * last + before) > self._threshold * scale * _JUMP):
            if self._support < _SUPPORT or self._believes(error):
                self._start(d, y, noise_std)
                return y
            self.count += 1
            self._course = predicted, last
            return predicted
        self._run = 0
        self._course = y, last
        self._support += 1
        # Least squares with forgetting; without motion the slope would wind up.
        s = _MEMORY + cc
        gain, gain_k, kk = cc / s, ck / s, (kk - ck * ck / s) / _MEMORY
        widest, ck = _STIFFEST / scale, gain_k
        widest *= widest
        if kk > widest:
            ck, kk = ck * sqrt(widest / kk), widest
        self._line = d, predicted + gain * error, slope + gain_k * error, gain, ck, kk
        return y

    def _believes(self, error: float) -> bool:
        """Count an outlier; return whether so many on one side are a change."""
        side = 1 if error > 0.0 else -1
        self._run = self._run + side if self._run * side > 0 else side
        return abs(self._run) >= self._samples

    def _start(self, d: float, y: float, noise_std: float) -> None:
        self._line = d, y, 0.0, 1.0, 0.0, (_STIFFEST / max(self._scale, noise_std)) ** 2
        self._course = y, y
        self._run = self._support = 0
