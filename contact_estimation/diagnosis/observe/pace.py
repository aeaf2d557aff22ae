# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The pace of a recording: from creep tests over hours to bursts of a fraction of a second."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

_FASTEST_S, _SLOWEST_S = 0.9e-3, 1.1e-2  # sample periods between which the pace is 1
_SHORT_S = 2.0  # duration below which times shrink
Array = NDArray[np.float64]

_SAMPLES = 2000  # that tell it, at most
_HARMONICS = 5
_LEAST_CYCLES = 4
_LEFT = 0.05  # of the variance of the motion, that no harmonic explains
_EXACTLY = 0.15  # of the resolution of the recording, 1 / duration


def pace_of(h: float, duration: float) -> float:
    """
    Return the factor on all times of the diagnosis.

    Its times (windows, blocks, memories) suit contacts that are sampled at 100 Hz to 1 kHz for
    seconds. Slower sampling lengthens them, so that they hold as many samples as at 100 Hz; faster
    sampling and a short recording shorten them.
    """
    by_rate = max(h / _SLOWEST_S, min(1.0, h / _FASTEST_S))
    return min(by_rate, duration / _SHORT_S) if duration > 0.0 else by_rate


def is_slow(h: float) -> bool:
    """Return whether sampling is too slow to take the motion between samples for known."""
    return h > _SLOWEST_S


def cycle_frequency(t: Array, x: Array) -> float:
    """Measure the frequency at which a motion repeats itself."""
    step = -(-len(t) // _SAMPLES)
    t, x = t[::step], x[::step] - np.mean(x[::step])
    duration = float(t[-1] - t[0])
    spectrum = np.abs(np.fft.rfft(x * np.hanning(len(x)))[1:])
    peak = (1.0 + float(np.argmax(spectrum))) * (len(t) - 1.0) / len(t) / duration
    variance = float(x @ x)
    if peak * duration < _LEAST_CYCLES - 0.5 or not variance:
        return 0.0

    def left(frequency: float) -> float:
        angles = 2.0 * pi * frequency * np.multiply.outer(np.arange(1, _HARMONICS + 1), t)
        tones = np.vstack((np.ones(len(t)), np.cos(angles), np.sin(angles))).T
        return float(np.sum((x - tones @ np.linalg.lstsq(tones, x, rcond=None)[0]) ** 2))

    best = minimize_scalar(left, method='bounded', options={'xatol': 1e-3 / duration},
                           bounds=(peak - 1.0 / duration, peak + 1.0 / duration))
    return float(best.x) if best.fun < _LEFT * variance else 0.0


def keeps_step(tones: tuple[float, ...], cycle: float, duration: float) -> bool:
    """Return whether all tones are multiples of the frequency of a cyclic test."""
    away = [abs(tone - max(1, round(tone / cycle)) * cycle) for tone in tones if cycle]
    return bool(away) and max(away) * duration < _EXACTLY
