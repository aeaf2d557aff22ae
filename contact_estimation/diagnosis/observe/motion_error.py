# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Errors of a smoothed motion that is coarse in time or in position."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from .smoothing import differentiate, is_slow, rate_noise

Array = NDArray[np.float64]

_WHOLE = 0.02  # of a step: largest deviation of quantised values from whole steps
_COMMON, _NEARLY_ALL = 0.05, 0.97  # of the changes
_RESTS = 0.5  # of the samples
_MOST_STEPS = 1_000_000  # in the range of a signal; finer ones are rounded numbers
_RARELY = 3.5  # standard deviations
_BESIDE = 5  # samples: reach of an error of differentiation


def quantisation_step(values: Array) -> float:
    """Find the resolution of a signal."""
    return max(_of_levels(values), _of_changes(values))


def _of_changes(values: Array) -> float:
    """
    Return the step of which nearly all changes are multiples: a single shift does not count.

    The signal must rest between its steps, or constant speed would look like one.
    """
    changes = np.abs(np.diff(values))
    rests = changes == 0.0
    if np.mean(rests) < _RESTS or rests.all():
        return 0.0
    changes = changes[~rests]
    size = np.median(changes)
    steps, counts = np.unique(np.round(changes / size, 3), return_counts=True)
    common = steps[counts >= _COMMON * len(changes)] * size
    if len(common) == 0 or common[0] == 0.0:
        return 0.0
    multiples = changes / common[0]
    whole = np.abs(multiples - np.round(multiples)) < _WHOLE
    return float(common[0]) if np.mean(whole) > _NEARLY_ALL else 0.0


def _of_levels(values: Array) -> float:
    """Return the step of which all differences are multiples."""
    levels = np.unique(values)
    if len(levels) < 2:
        return 0.0
    steps = np.diff(levels)
    span = float(levels[-1] - levels[0])
    step = float(np.min(steps[steps > span / _MOST_STEPS], initial=np.inf))
    if not np.isfinite(step):
        return 0.0
    counts = (levels - levels[0]) / step
    # The least difference is slightly off by rounding: fit it to the whole range.
    step = span / max(1.0, float(np.round(counts[-1])))
    counts = (levels - levels[0]) / step
    return step if np.max(np.abs(counts - np.round(counts))) < _WHOLE else 0.0


def motion_error(
    x: Array, v: Array, h: float, step: float, cutoff: float, noise: float,
    left: Array | None,
) -> Array | None:
    """
    Estimate the errors of a smoothed motion.

    Between samples far apart the motion is unknown: at half the rate position and velocity would
    come out differently, and these differences are the errors. A quantised position is off by up
    to half a step for as long as it rests.
    """
    if not is_slow(h) and step == 0.0 and left is None:
        return None
    x_error = step / sqrt(12.0)
    v_error = rate_noise(x_error, cutoff, h)
    errors = np.tile([[x_error], [v_error]], len(x))
    if is_slow(h) or left is not None:
        errors = np.hypot(errors, _lost_between_samples(x, v, h))
    if left is not None:
        errors = np.hypot(errors, noise * _lost_by_smoothing(left / noise, h, cutoff))
    return np.asarray(errors)


def _lost_between_samples(x: Array, v: Array, h: float) -> Array:
    places = np.arange(len(x), dtype=np.float64)
    half = differentiate(x[::2], 2.0 * h)
    lost = [0.5 * np.abs(x - np.interp(places, places[::2], half.value)),
            np.abs(v - np.interp(places, places[::2], half.rate))]
    return np.asarray(maximum_filter1d(lost, _BESIDE, axis=1))


def _lost_by_smoothing(left: Array, h: float, cutoff: float) -> Array:
    """Return the errors at sharp bends, where smoothing leaves more than noise."""
    span = max(1, round(0.5 / (cutoff * h)))
    power = np.convolve(left**2, np.ones(span) / span, mode='same')
    # Of noise alone the mean power rarely exceeds this.
    excess = np.maximum(power - 1.0 - _RARELY * sqrt(2.0 / span), 0.0)
    x_error = maximum_filter1d(np.sqrt(excess), span)
    return np.asarray([x_error, 2.0 * pi * cutoff * x_error])


def lost_by_lines(signal: Array) -> Array:
    """Estimate how far a signal strays from straight lines between its samples."""
    bends = np.zeros(len(signal))
    bends[1:-1] = 0.25 * np.abs(np.diff(signal, 2))
    return np.asarray(maximum_filter1d(bends, 3))
