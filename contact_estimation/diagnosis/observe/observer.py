# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Motion of second-order dynamics under a force, and the innovations of an observer of it.

A model's misfit in position, run free, keeps every error for as long as the dynamics remember it.
The innovations x - x_predicted of an observer with cut-off omega_o forget it after 1 / omega_o,
and are white if the model is correct.
"""

from __future__ import annotations

from math import exp
from typing import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import freqz, lfilter

from ...physics.numeric import SecondOrder

Array = NDArray[np.float64]

_FREQUENCIES = 4096  # at which spectra are averaged

OBSERVER_CUTOFF = 50.0
"""omega_o [rad/s] at a pace of 1: errors in the time of an impact are forgotten in 40 ms."""


def run(system: SecondOrder, force: Array, position: float, stiffness: float) -> Array:
    """Simulate the dynamics from rest."""
    moved = lfilter(system.position, system.denominator, force - stiffness * position)
    return np.asarray(moved + position)


def run_velocity(system: SecondOrder, force: Array, position: float, stiffness: float) -> Array:
    """Simulate the dynamics from rest; parameters as `run`."""
    return np.asarray(lfilter(system.velocity, system.denominator, force - stiffness * position))


def run_from(system: SecondOrder, force: Array, state: Array) -> Array:
    """Simulate the dynamics from a state."""
    poles = system.denominator
    rows = zip((system.position, system.velocity), state, system.transition @ state)
    return np.array([
        lfilter(row, poles, force, zi=[first, second + poles[1] * first])[0]
        for row, first, second in rows])


def coast(system: SecondOrder, count: int) -> Array:
    """Simulate the dynamics without a force."""
    rest = np.zeros(count)
    return np.array([run_from(system, rest, state) for state in np.eye(2)])


def innovations(misfit: Array, system: SecondOrder, cutoff: float, h: float) -> Array:
    """Filter the misfit of a free run to the innovations of an observer."""
    pole = exp(-cutoff * h)
    return np.asarray(lfilter(system.denominator, [1.0, -2.0 * pole, pole * pole], misfit))


def innovations_of(
    force: Array, system: SecondOrder, observer: SecondOrder, cutoff: float, h: float
) -> Array:
    """Filter the motion that a force causes to the innovations of an observer."""
    if not np.array_equal(system.denominator, observer.denominator):
        return innovations(run(system, force, 0.0, 0.0), observer, cutoff, h)
    pole = exp(-cutoff * h)  # the poles of the dynamics are zeros of the observer
    return np.asarray(lfilter(system.position, [1.0, -2.0 * pole, pole * pole], force))


def innovations_under(
    force: Array, position: Array, start: float, system: SecondOrder, denominator: Array,
    stiffness: float,
) -> Array:
    """
    Filter the misfit of a run from rest under a force, without running it.

    The poles of the dynamics are zeros of the filter a / c, with a their denominator: what is left
    is (a x - b f) / c, with b the numerator of the position.
    """
    x, f = position - start, force - stiffness * start
    (_, a_1, a_2), (b_0, b_1, b_2) = system.denominator.tolist(), system.position.tolist()
    left = x - b_0 * f
    left[1:] += a_1 * x[:-1] - b_1 * f[:-1]
    left[2:] += a_2 * x[:-2] - b_2 * f[:-2]
    return np.asarray(lfilter([1.0], denominator, left))


def kalman_filter(
    system: SecondOrder, force_noise: float, position_noise: float,
    weights: Sequence[float] = (1.0,),
) -> tuple[Array, float]:
    """
    Design the stationary Kalman filter of dynamics driven by a noisy force.

    With a and b the polynomials of the position's transfer function, the spectra of both noises
    add up to S |c|^2 = force_noise^2 |b|^2 + position_noise^2 |a|^2; the misfit of a free run
    filtered by a / c is the innovation (spectral factorisation; Ljung 1999, section 4.3).
    """
    a, b = system.denominator, np.convolve(system.position, weights)
    a = np.pad(a, (0, len(b) - len(a)))
    spectrum = (force_noise**2 * np.correlate(b, b, 'full')
                + position_noise**2 * np.correlate(a, a, 'full'))
    if not np.isfinite(spectrum).all():  # values far from the optimum
        return a, np.inf
    roots = np.roots(spectrum)
    count = len(b) - 1
    c = np.real(np.poly(roots[np.argsort(np.abs(roots))[:count]]))
    return c, float(np.sqrt(spectrum[count] / (c @ c)))


def innovation_std(
    system: SecondOrder, denominator: Array, force_noise: float, position_noise: float,
    weights: Sequence[float], block: int,
) -> float:
    """Compute what the noise of force and position leaves in innovations of any filter."""
    c = freqz([1.0], denominator, worN=_FREQUENCIES)[1]
    a = freqz(system.denominator, [1.0], worN=_FREQUENCIES)[1]
    b = freqz(np.convolve(system.position, weights), [1.0], worN=_FREQUENCIES)[1]
    averaged = freqz(np.full(block, block**-0.5), [1.0], worN=_FREQUENCIES)[1] * c
    spectrum = (force_noise * np.abs(b)) ** 2 + (position_noise * np.abs(a)) ** 2
    return float(np.sqrt(np.mean(spectrum * np.abs(averaged) ** 2)))
