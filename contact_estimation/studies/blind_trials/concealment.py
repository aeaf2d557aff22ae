# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Degree of concealment of an effect, and search for the strength that gives a degree.

Concealed r times: the RMS force residual of a refitted spring-damper in contact is r times that
of the same world without the effect. For effects that the motion of the robot tells: likewise the
residual of eq. (1) with the nominal robot and central differences of the measured position.
"""

from __future__ import annotations

from math import hypot, sqrt
from typing import Callable, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .worlds import RandomWorld, Run

Array = NDArray[np.float64]

TOLERANCE = 0.1
"""Accepted relative deviation from the requested degree."""

_SIMULATIONS = 9
_WINDOW_S, _GAP_S = 0.1, 0.3  # of `active_intervals`
_CONVERGED = 0.02  # relative deviation that ends the search
_FIRST_STRENGTH = 0.03
_MIN_STRENGTH = 1e-4
_MAX_FACTOR = 12.0  # of one step of the search


class Concealed(NamedTuple):
    """Result of the search."""

    strength: float  # strength of the effect, 0 to 1
    degree: float  # degree of concealment r
    # the degree exceeds the requested one at any strength, or jumps over it
    not_concealable: bool = False


def degree(in_motion: bool, world: RandomWorld, run: Run, without: Run) -> float:
    """Compute the degree of concealment."""
    noise = _impedance_noise(world) if in_motion else world.sensors.force_std
    return rms_ratio(noise, residual(in_motion, world, run), residual(in_motion, world, without))


def rms_ratio(noise: float, with_effect: Array, without: Array) -> float:
    """Compute the ratio of two RMS residuals (N,) [N], both with white noise of a std [N]."""
    rms, rms_without = (float(np.sqrt(np.nanmean(each**2))) for each in (with_effect, without))
    return hypot(noise, rms) / hypot(noise, rms_without)


def residual(in_motion: bool, world: RandomWorld, run: Run) -> Array:
    """Return the residual in which an effect shows, shape (N,) [N]; NaN where undefined."""
    return _impedance_residual(world, run) if in_motion else _contact_residual(world, run)


def active_intervals(residual: Array, t: Array) -> list[tuple[float, float]]:
    """
    Find the intervals in which a residual is large.

    residual (N,): residual [N]; NaN counts as 0
    t (N,): time, evenly spaced [s]
    Returns intervals: where the RMS over 0.1 s exceeds half of the overall RMS [s]; intervals less
    than 0.3 s apart are joined
    """
    residual, h = np.nan_to_num(residual), float(t[1] - t[0])
    if not residual.any():
        return []
    width = max(1, round(_WINDOW_S / h))
    power = np.convolve(residual**2, np.ones(width) / width, mode='same')
    large = np.flatnonzero(power > 0.25 * float(np.mean(residual[residual != 0.0] ** 2)))
    breaks = np.flatnonzero(np.diff(large) * h > _GAP_S) + 1
    return [(float(t[part[0]]), float(t[part[-1]]))
            for part in np.split(large, breaks) if len(part)]


def _contact_residual(world: RandomWorld, run: Run) -> Array:
    """Refit K_e and B_e to the force in contact; NaN where no contact force acts or is due."""
    d = run.x - world.wall.location
    phi: Array = -np.column_stack((d, run.v))  # eq. (7)
    pressing = (run.force < 0.0) & (d > 0.0)
    theta = np.linalg.lstsq(phi[pressing], run.sensed[pressing], rcond=None)[0]
    # Eq. (3): the refitted wall cannot pull.
    predicted = np.where(d > 0.0, np.minimum(0.0, phi @ theta), 0.0)
    touching = (d > 0.0) | (run.force != 0.0)
    return np.where(touching, run.sensed - predicted, np.nan)


def _impedance_residual(world: RandomWorld, run: Run) -> Array:
    """Evaluate M_t (a - xdd_r) + B_t (v - xd_r) + K_t (x - x_r) - F_e of eq. (1) [N]."""
    robot, h = world.robot, float(run.t[1] - run.t[0])
    v = np.gradient(run.x, h)
    a = np.gradient(v, h)
    balance = (robot.mass * (a - run.a_r) + robot.damping * (v - run.v_r)
               + robot.stiffness * (run.x - run.x_r) - run.sensed)
    balance[:2] = balance[-2:] = np.nan
    return np.asarray(balance)


def _impedance_noise(world: RandomWorld) -> float:
    """Propagate white position and force noise through eq. (1) with central differences [N]."""
    robot, sensors = world.robot, world.sensors
    h = 1.0 / sensors.rate
    taps = np.zeros(5)
    taps += robot.mass / (2.0 * h) ** 2 * np.array([1.0, 0.0, -2.0, 0.0, 1.0])
    taps += robot.damping / (2.0 * h) * np.array([0.0, -1.0, 0.0, 1.0, 0.0])
    taps[2] += robot.stiffness
    return hypot(sensors.position_std * sqrt(float(taps @ taps)), sensors.force_std)


def conceal(
    degree_of: Callable[[float], float], requested: float, first: float = _FIRST_STRENGTH,
    simulations: int = _SIMULATIONS, converged: float = _CONVERGED,
) -> Concealed:
    """
    Search the strength at which an effect is concealed to a requested degree.

    The residual grows about in proportion to the strength: a secant of the logarithms converges
    in a few simulations.
    """
    goal, strength = _excess(requested), first
    below: tuple[float, float] | None = None
    above: tuple[float, float] | None = None
    best = Concealed(0.0, 1.0)
    for _ in range(simulations):
        r = degree_of(strength)
        if abs(r - requested) < abs(best.degree - requested):
            best = Concealed(strength, r)
        at_end = strength == (1.0 if r < requested else _MIN_STRENGTH)
        if abs(r / requested - 1.0) < converged or at_end:
            break
        if r < requested:
            below = strength, _excess(r)
        else:
            above = strength, _excess(r)
        strength = min(1.0, max(_MIN_STRENGTH, _next(below, above, goal)))
    missed = abs(best.degree / requested - 1.0) > TOLERANCE
    return best._replace(not_concealable=above is not None and missed)


def _excess(r: float) -> float:
    """Compute the residual of the effect alone, in units of the residual without it."""
    return sqrt(max(r * r - 1.0, 1e-6))


def _next(
    below: tuple[float, float] | None, above: tuple[float, float] | None, goal: float
) -> float:
    """Interpolate the logarithms where the goal is bracketed, else extrapolate in proportion."""
    if below is not None and above is not None:
        slope = np.log(above[1] / below[1])
        share = float(np.clip(np.log(goal / below[1]) / max(slope, 1e-9), 0.05, 0.95))
        return float(below[0] * (above[0] / below[0]) ** share)
    last, excess = below or above or (_FIRST_STRENGTH, goal)
    return last * float(np.clip(goal / excess, 1.0 / _MAX_FACTOR, _MAX_FACTOR))
