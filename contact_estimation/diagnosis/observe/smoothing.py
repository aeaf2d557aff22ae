# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Smooth motion from noisy positions, by the least bandwidth that leaves noise; its errors."""

from math import pi, sqrt
from typing import NamedTuple, Sequence

import numpy as np
from scipy.linalg import solveh_banded
from scipy.ndimage import maximum_filter1d
from scipy.signal import welch

from .shares import MOST, SLIGHT
from ...physics.numeric import Array

STEADY_CUTOFFS_HZ = tuple(6.0 * 1.5**k for k in range(-7, 9))  # at a pace of 1
"""Those of a motion at nearly constant speed."""

CUTOFFS_HZ = STEADY_CUTOFFS_HZ[7:]
"""Those of any motion, from 6 Hz on."""

_THIRD_DIFFERENCE = (-1.0, 3.0, -3.0, 1.0)
_SLOWEST = 0.003  # cycles per sample: below, the equations of `smooth` are nearly singular
_LEAST_NOISE = 1e-4  # of the range of a force
_FELT = 10.0  # times the noise of the force


class Derivatives(NamedTuple):
    """A smooth signal with its derivatives."""

    # value, rate, acceleration (N,): in the signal's unit, per second, per second squared
    value: Array
    rate: Array
    acceleration: Array


def smooth(signal: Array, weight: Array, cutoff_cycles: float) -> Array:
    """Minimise sum w (y - s)^2 + lambda sum (third difference of s)^2 (Whittaker 1923)."""
    stiffness = (2.0 * pi * cutoff_cycles) ** -6
    count, c = len(signal), _THIRD_DIFFERENCE
    bands = np.zeros((4, count))
    for i in range(4):
        for j in range(i, 4):
            bands[3 - (j - i), j:count - 3 + j] += stiffness * c[i] * c[j]
    bands[3] += weight
    return np.asarray(solveh_banded(bands, weight * signal, check_finite=False))


def differentiate(signal: Array, h: float) -> Derivatives:
    """Differentiate twice by central differences of fourth order."""
    y, v = signal, np.gradient(signal, h)
    a = np.gradient(v, h)
    v[2:-2] = (8.0 * (y[3:-1] - y[1:-3]) - (y[4:] - y[:-4])) / (12.0 * h)
    a[2:-2] = (16.0 * (y[3:-1] + y[1:-3]) - 30.0 * y[2:-2] - y[4:] - y[:-4]) / (12.0 * h * h)
    return Derivatives(y, v, a)


def white_noise_std(signal: Array) -> float:
    """Estimate white noise under a signal of less bandwidth from the top of its spectrum."""
    span = min(256, len(signal) // 4)
    cycles, power = welch(np.diff(signal, 2), 1.0, nperseg=span, average='median')
    top = (cycles > 0.4) & (cycles < 0.49)
    whitened = power[top] / (2.0 - 2.0 * np.cos(2.0 * pi * cycles[top])) ** 2
    return float(np.sqrt(0.5 * np.median(whitened)))


def least_noise(force: Array) -> float:
    """Return the least noise of a force sensor that is worth assuming."""
    return _LEAST_NOISE * float(np.ptp(force))


def smooth_enough(
    signal: Array, weight: Array, h: float, noise: float, pace: float = 1.0,
    cutoffs: Sequence[float] = CUTOFFS_HZ,
) -> tuple[Array, float]:
    """Smooth with the lowest cut-off whose residual is only noise."""
    measured = weight > 0.5
    smoothed, cutoff = signal, 0.4 / h
    for cutoff in (at_pace_1 / pace for at_pace_1 in cutoffs):
        if cutoff * h < _SLOWEST:
            continue
        if cutoff * h > 0.3:
            break
        smoothed = smooth(signal, weight, cutoff * h)
        left = (signal - smoothed)[measured]
        # A share of 5 % in the misfit's variance is a tenth of the noise in the band left out.
        if np.mean(np.minimum(np.abs(left), 4.0 * noise) ** 2) <= 1.05 * noise**2:
            break
    return smoothed, cutoff


def rate_noise(noise: float, cutoff: float, h: float) -> float:
    """Bound the standard deviation of the rate of a smoothed signal."""
    return noise * 2.0 * pi * cutoff * sqrt(min(1.0, 2.0 * cutoff * h))


def slower_by_force(
    force: Array, weight: Array, h: float, felt: float, pace: float
) -> float | None:
    """
    Return the cut-off of the force of a static wall, where the noise of the motion needs it.

    What such a wall does shows in its force at once: a motion that is faster than the force is
    noise, whatever its spectrum. The rate would else be little but noise, which hides the damping
    and every misfit.
    """
    noise = max(white_noise_std(force), least_noise(force))
    return None if felt < _FELT * noise else smooth_enough(force, weight, h, noise, pace)[1]


_FASTEST_S, _SLOWEST_S = 0.9e-3, 1.1e-2  # sample periods between which the pace is 1
_SHORT_S = 2.0  # duration below which times shrink


def pace_of(h: float, duration: float) -> float:
    """Return the factor on all times of the diagnosis."""
    # Its times (windows, blocks, memories) suit contacts that are sampled at 100 Hz to 1 kHz for
    # seconds. Slower sampling lengthens them, so that they hold as many samples as at 100 Hz;
    # faster sampling and a short recording shorten them.
    by_rate = max(h / _SLOWEST_S, min(1.0, h / _FASTEST_S))
    return min(by_rate, duration / _SHORT_S) if duration > 0.0 else by_rate


def is_slow(h: float) -> bool:
    """Return whether sampling is too slow to take the motion between samples for known."""
    return h > _SLOWEST_S


_COMMON, _NEARLY_ALL = 0.05, 0.97  # of the changes
_MOST_STEPS = 1_000_000  # in the range of a signal; finer ones are rounded numbers
_RARELY = 3.5  # standard deviations
_BESIDE = 5  # samples: reach of an error of differentiation


def quantisation_step(values: Array) -> float:
    """Find the resolution of a signal."""
    return max(_of_levels(values), _of_changes(values))


def _of_changes(values: Array) -> float:
    """Return the step of which nearly all changes are multiples: a single shift does not count."""
    # The signal must rest between its steps, or constant speed would look like one.
    changes = np.abs(np.diff(values))
    rests = changes == 0.0
    if np.mean(rests) < MOST or rests.all():
        return 0.0
    changes = changes[~rests]
    size = np.median(changes)
    steps, counts = np.unique(np.round(changes / size, 3), return_counts=True)
    common = steps[counts >= _COMMON * len(changes)] * size
    if len(common) == 0 or common[0] == 0.0:
        return 0.0
    multiples = changes / common[0]
    whole = np.abs(multiples - np.round(multiples)) < SLIGHT
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
    return step if np.max(np.abs(counts - np.round(counts))) < SLIGHT else 0.0


def motion_error(
    x: Array, v: Array, h: float, step: float, cutoff: float, noise: float, left: Array | None
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
