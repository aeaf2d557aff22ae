# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Smooth paths with analytic derivatives, the sum of pieces, for the worlds of the studies."""

from math import pi
from typing import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Piece = Callable[[Array], Array]
"""Takes times [s]; returns position [m], velocity and acceleration, shape (3, N)."""


def path_at(pieces: Sequence[Piece], t: Array) -> Array:
    """Return position [m], velocity and acceleration, shape (3, N), of a path of pieces."""
    return np.asarray(sum((piece(t) for piece in pieces), np.zeros((3, len(t)))))


def start(position: float) -> Piece:
    """Stay at a position [m]."""
    return lambda t: np.array([np.full_like(t, position), np.zeros_like(t), np.zeros_like(t)])


def ramp(begin: float, seconds: float, distance: float) -> Piece:
    """Move by a distance along a quintic."""
    def piece(t: Array) -> Array:
        s = np.clip((t - begin) / seconds, 0.0, 1.0)
        return distance * np.array([
            s**3 * (10.0 - 15.0 * s + 6.0 * s**2),
            30.0 * (s * (1.0 - s))**2 / seconds,
            60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / seconds**2])

    return piece


def cruise(begin: float, end: float, speed: float, fade_s: float) -> Piece:
    """Reach a constant speed within `fade_s` of `begin`, and rest within `fade_s` after `end`."""
    faster, slower = ramp(begin, fade_s, speed), ramp(end, fade_s, -speed)

    def piece(t: Array) -> Array:
        rate, acceleration, _ = faster(t) + slower(t)
        covered = _integral((t - begin) / fade_s) - _integral((t - end) / fade_s)
        return np.array([speed * fade_s * covered, rate, acceleration])

    return piece


def _integral(s: Array) -> Array:
    """Return the integral of the quintic of `ramp` from 0."""
    u = np.clip(s, 0.0, 1.0)
    return np.asarray(u**4 * (2.5 - 3.0 * u + u**2) + np.maximum(s - 1.0, 0.0))


def tones(
    begin: float, end: float, size: float, omegas: Array, phases: Array, fade_s: float
) -> Piece:
    """Add sines of one size, faded in and out, of angular frequencies [rad/s] and phases [rad]."""
    fade_in, fade_out = ramp(begin, fade_s, size), ramp(end - fade_s, fade_s, -size)

    def piece(t: Array) -> Array:
        size, size_1, size_2 = fade_in(t) + fade_out(t)
        angles = omegas[:, None] * t + phases[:, None]
        wave = np.sin(angles).sum(axis=0)
        wave_1 = (omegas[:, None] * np.cos(angles)).sum(axis=0)
        wave_2 = (-omegas[:, None]**2 * np.sin(angles)).sum(axis=0)
        return np.array([size * wave, size_1 * wave + size * wave_1,
                         size_2 * wave + 2.0 * size_1 * wave_1 + size * wave_2])

    return piece


def sines(begin: float, end: float, amplitude: float, draw: np.random.Generator) -> Piece:
    """Add three sines of 1 to 8 Hz, together at most `amplitude`, faded within 0.3 s."""
    omegas, phases = 2.0 * pi * draw.uniform(1.0, 8.0, 3), draw.uniform(0.0, 2.0 * pi, 3)
    return tones(begin, end, amplitude / 3.0, omegas, phases, 0.3)


def bump(centre: float, half_width_s: float, height: float) -> Piece:
    """Move by a height and back at once: height (1 - u^2)^3."""
    def piece(t: Array) -> Array:
        u = np.clip((t - centre) / half_width_s, -1.0, 1.0)
        w = 1.0 - u * u
        return height * np.array([w**3, -6.0 * u * w**2 / half_width_s,
                                  (24.0 * u * u * w - 6.0 * w**2) / half_width_s**2])

    return piece
