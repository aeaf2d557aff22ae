# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Contacts in closed form: a prescribed smooth path, a law of the wall, white noise."""

from typing import Callable, NamedTuple

from contact_estimation.estimators.multiple_model import WallPosterior
from contact_estimation.studies.paths import ramp
import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]
Law = Callable[[Array, Array, Array], Array]

FINE = 10_000.0  # rate of the law and of the lag [Hz]
OUTSIDE = 0.005  # where the tool waits before the wall [m]


class Samples(NamedTuple):
    """Stamps [s], pressing force [N], position [m], and the depth without noise [m]."""

    t: Array
    force: Array
    x: Array
    depth: Array


def spring_damper(K: float, B: float) -> Law:
    """Return the law K d + B v."""
    return lambda d, v, a: K * d + B * v


def press(t: Array, begin: float, end: float, depth: float, shaken: float) -> Array:
    """Return a press to a depth [m], shaken in three tones of an amplitude [m], shape (3, N)."""
    level = ramp(begin, 0.25, 1.0)(t) - ramp(end - 0.25, 0.25, 1.0)(t)
    window = ramp(begin + 0.25, 0.3, 1.0)(t) - ramp(end - 0.55, 0.3, 1.0)(t)
    tone = np.zeros((3, len(t)))
    for omega, phase in ((13.0, 0.3), (31.0, 1.1), (67.0, 2.0)):
        angle = omega * t + phase
        tone += [np.sin(angle), omega * np.cos(angle), -omega**2 * np.sin(angle)]
    products = np.array([
        window[0] * tone[0], window[1] * tone[0] + window[0] * tone[1],
        window[2] * tone[0] + 2.0 * window[1] * tone[1] + window[0] * tone[2]])
    return np.asarray((depth + OUTSIDE) * level + shaken / 3.0 * products)


def contact(
    law: Law, seconds: float = 3.5, depth: float = 0.008, shaken: float = 0.002,
    noise: float = 0.2, rate: float = 500.0, seed: int = 1, surface: float = 0.0,
    presses: tuple[tuple[float, float], ...] = (), pole_s: float = 0.0, delay_s: float = 0.0,
    position_noise: float = 1e-6, wall: Callable[[Array], Array] | None = None,
) -> Samples:
    """
    Press once from 0.2 s to the end, or several times.

    law: force of depth, rate and acceleration; it acts inside the wall, and never pulls
    depth, shaken: of the press, and amplitude of the excitation [m]
    presses: begin and end of each [s]
    pole_s, delay_s: time constant of a low-pass in the sensor, and a delay [s]
    wall: motion of the wall with two derivatives, shape (3, N)
    """
    t = np.arange(round(seconds * FINE)) / FINE
    late = t - delay_s

    def inside(time: Array) -> Array:
        path = sum((press(time, begin, end, depth, shaken)
                    for begin, end in presses or ((0.2, seconds + 1.0),)), np.zeros((3, len(t))))
        path[0] -= OUTSIDE
        return np.asarray(path - wall(time) if wall else path)

    d, v, a = inside(late)
    force = np.where(d > 0.0, np.maximum(law(d, v, a), 0.0), 0.0)
    if pole_s:
        gain = 1.0 - np.exp(-1.0 / (FINE * pole_s))
        force = lfilter([gain], [1.0, gain - 1.0], force)
    at = np.arange(0.0, t[-1], 1.0 / rate)
    draw = np.random.default_rng(seed)
    path = inside(t)[0] + (wall(t)[0] if wall else 0.0)
    tip = np.interp(at, t, path)
    return Samples(
        at, np.interp(at, t, force) + noise * draw.standard_normal(len(at)),
        surface + tip + position_noise * draw.standard_normal(len(at)),
        np.interp(at, t, inside(t)[0]))


def fed(samples: Samples, posterior: WallPosterior | None = None) -> WallPosterior:
    """Return a posterior, by default one that knows x_e = 0 to 2 mm, after the samples."""
    posterior = posterior or WallPosterior(0.0, 2e-3)
    for t, force, x, _ in zip(*(one.tolist() for one in samples)):
        posterior.take(t, force, x)
    return posterior
