# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Degree of concealment of a law, and search for the strength that gives a degree.

Concealed r times: the RMS force residual of a refitted spring-damper in contact is r times that
of the same world without the law. For laws that the motion of the robot tells: likewise the
residual of eq. (1) with the nominal robot.
"""

from math import hypot, pi, sqrt
from typing import Callable, NamedTuple

import numpy as np
from scipy.signal import butter, filtfilt

from .world import Array, Run, World

_WINDOW_S, _GAP_S = 0.1, 0.3  # of `active_intervals`
_ROBOT_HZ = 15.0  # corner of the filter of the residual of eq. (1) of a rig
_MIN_STRENGTH = 1e-4
_MAX_FACTOR = 12.0  # of one step of the search


def degree(in_motion: bool, world: World, run: Run, without: Run) -> float:
    """Compute the degree of concealment."""
    noise = world.sensors.force_std
    if in_motion:
        noise = hypot(noise, world.sensors.position_std * _motion_gain(world))
    rms, rms_without = (float(np.sqrt(np.nanmean(residual(in_motion, world, each)**2)))
                        for each in (run, without))
    return hypot(noise, rms) / hypot(noise, rms_without)


def residual(in_motion: bool, world: World, run: Run) -> Array:
    """Return the residual in which a law shows, shape (N,) [N]; NaN where undefined."""
    return _impedance_residual(world, run) if in_motion else _contact_residual(world, run)


def active_intervals(residual: Array, t: Array) -> list[tuple[float, float]]:
    """Return where the RMS over 0.1 s exceeds half the overall one [s]; gaps below 0.3 s join."""
    residual, h = np.nan_to_num(residual), float(t[1] - t[0])
    if not residual.any():
        return []
    width = max(1, round(_WINDOW_S / h))
    power = np.convolve(residual**2, np.ones(width) / width, mode='same')
    large = np.flatnonzero(power > 0.25 * float(np.mean(residual[residual != 0.0] ** 2)))
    breaks = np.flatnonzero(np.diff(large) * h > _GAP_S) + 1
    return [(float(t[part[0]]), float(t[part[-1]]))
            for part in np.split(large, breaks) if len(part)]


def _contact_residual(world: World, run: Run) -> Array:
    """Refit spring and damper, and mass if the world has one, to the force in contact."""
    # In an ideal world NaN where no contact force acts or is due; on a rig free flight counts,
    # too.
    d, wall = run.x - world.wall.location, world.wall
    columns = [d] * bool(wall.stiffness) + [run.v]
    columns += [np.gradient(run.v, run.t)] * bool(wall.inertia)
    phi: Array = -np.column_stack(columns)  # eq. (7)
    pressing = (run.force < 0.0) & (d > 0.0) if wall.unilateral else np.ones(len(d), bool)
    predicted = phi @ np.linalg.lstsq(phi[pressing], run.sensed[pressing], rcond=None)[0]
    if wall.unilateral:  # Eq. (3): the refitted wall cannot pull.
        predicted = np.where(d > 0.0, np.minimum(0.0, predicted), 0.0)
    counted = world.is_rig | (d > 0.0) | (run.force != 0.0)
    return np.where(counted, run.sensed - predicted, np.nan)


def _impedance_residual(world: World, run: Run) -> Array:
    """Return M_t a - u - F_e of eq. (1) [N]: on a rig below 15 Hz, else of measured positions."""
    assert world.robot is not None
    h = float(run.t[1] - run.t[0])
    if not world.is_rig:
        run = run._replace(v=np.gradient(run.x, h))
    balance = np.asarray(
        world.robot.mass * np.gradient(run.v, h) - run.control(world.robot) - run.sensed)
    if world.is_rig:
        return np.asarray(filtfilt(*butter(2, _ROBOT_HZ, fs=1.0 / h), balance))
    balance[:2] = balance[-2:] = np.nan
    return balance


def _motion_gain(world: World) -> float:
    """Return the std of the residual of eq. (1) for white noise of the position of 1 m [N]."""
    robot, rate = world.robot, world.sensors.rate
    assert robot is not None
    if world.is_rig:  # below the corner of its filter
        omega = 2.0 * pi * np.linspace(0.0, _ROBOT_HZ, 100)
        gain = np.hypot(robot.stiffness - robot.mass * omega**2, robot.damping * omega)
        return float(np.sqrt(2.0 * _ROBOT_HZ / rate * np.mean(gain**2)))
    taps = robot.mass * (0.5 * rate) ** 2 * np.array([1.0, 0.0, -2.0, 0.0, 1.0])
    taps += robot.damping * 0.5 * rate * np.array([0.0, -1.0, 0.0, 1.0, 0.0])
    taps[2] += robot.stiffness  # central differences
    return sqrt(float(taps @ taps))


class Concealed(NamedTuple):
    """Result of a search."""

    strength: float  # strength of the law, 0 to 1
    degree: float  # degree of concealment r
    is_exceeded: bool  # some strength exceeds the requested degree


class Search(NamedTuple):
    """Effort of a search."""

    simulations: int
    converged: float  # relative deviation that ends the search
    first: float  # strength


def conceal(degree_of: Callable[[float], float], requested: float, search: Search) -> Concealed:
    """
    Search the strength at which a law is concealed to a requested degree.

    The residual grows about in proportion to the strength: a secant of the logarithms converges
    in a few simulations.
    """
    goal, strength = _excess(requested), search.first
    below: tuple[float, float] | None = None
    above: tuple[float, float] | None = None
    best = Concealed(0.0, 1.0, False)
    for _ in range(search.simulations):
        r = degree_of(strength)
        if abs(r - requested) < abs(best.degree - requested):
            best = Concealed(strength, r, False)
        at_end = strength == (1.0 if r < requested else _MIN_STRENGTH)
        if abs(r / requested - 1.0) < search.converged or at_end:
            break
        if r < requested:
            below = strength, _excess(r)
        else:
            above = strength, _excess(r)
        strength = min(1.0, max(_MIN_STRENGTH, _next(below, above, goal)))
    return best._replace(is_exceeded=above is not None)


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
    known = below or above
    assert known is not None
    last, excess = known
    return last * float(np.clip(goal / excess, 1.0 / _MAX_FACTOR, _MAX_FACTOR))
