# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Worlds of the on-line study: walls and sensors that share nothing with `plant`."""

from math import nan, pi, sqrt
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, lfilter

from .paths import Array, path_at, Piece

FINE = 10_000.0
"""Rate at which force and filter of the sensor are computed [Hz]."""

EPOCH_NS = 10**18
"""Stamp of t = 0."""

_STAMP_STD = 1e-4  # [s]
_LOST = 0.002
_POSITION_STEP = 1e-6  # [m]
_SIGN_VELOCITY = 4e-4  # below which dry friction fades [m/s]
_MEAN_DEPTH_S = 0.5  # memory of the penetration at which a nonlinear K_e and B_e are published


class Wall(NamedTuple):
    """F = K d + B d' + M d'' + F_c sgn(d'), at least 0, at the depth d > 0 below the surface."""

    # stiffness, damping: K_e [N/m] and B_e [N s/m], of a Hunt-Crossley wall at `depth`
    stiffness: float
    damping: float
    location: float = 0.0  # x_e [m]
    exponent: float = nan  # of a Hunt-Crossley wall, K d^n + chi d^n d'; NaN: spring and damper
    # penetration at which a Hunt-Crossley wall has this stiffness and damping [m]
    depth: float = 0.01
    # mass, friction: m [kg] and F_c [N]
    mass: float = 0.0
    friction: float = 0.0
    factor: Callable[[Array], Array] | None = None  # stiffness over time, relative to `stiffness`
    shift: Piece | None = None  # displacement of the surface, a piece of a path


class Sensor(NamedTuple):
    """What is measured, and how."""

    lag_s: float = 1e-3  # delay of slow forces in the low-pass filter of the force sensor [s]
    poles: int = 1  # 1 or 2 (Butterworth), order of the filter
    # noise, zero: standard deviation of white noise and constant error of the force [N]
    noise: float = 0.2
    zero: float = 0.0
    position_noise: float = 1e-6  # standard deviation, besides steps of 1 um [m]
    velocity_noise: float = nan  # standard deviation [m/s]; NaN: velocity is not measured
    rate: float = 500.0  # of both topics [Hz]
    # mass between sensor and wall, whose inertia is measured with the force [kg]
    tool_mass: float = 0.0


class Stream(NamedTuple):
    """Messages of one topic."""

    t: Array  # (N,) when they were measured [s]
    stamp_ns: NDArray[np.int64]  # (N,) their stamps [ns]
    values: Array  # (N, M) F_e [N], or x [m] and v [m/s]


class Truth(NamedTuple):
    """What happened, at 1 kHz."""

    t: Array  # (N,) time [s]
    pressing: Array  # (N,) force on the wall [N], at least 0
    # stiffness, damping (N,): K_e [N/m] and B_e [N s/m]; of a Hunt-Crossley wall K d^(n - 1) and
    # chi d^n at the recent mean penetration, as the estimators publish them
    stiffness: Array
    damping: Array
    contacts: list[tuple[float, float]]  # begin and end of each [s]
    wall: Wall  # as simulated
    sensor: Sensor  # as simulated


class World(NamedTuple):
    """Messages with the truth."""

    group: str  # worlds of one row and group are summarised together
    parameters: Mapping[str, Any]  # parameters that are not defaults, by dotted name
    # wrenches, motions: messages
    wrenches: Stream
    motions: Stream
    truth: Truth  # what happened
    marks: Mapping[str, float] = {}  # times that a row needs [s]


def pressing_force(wall: Wall, delta: Array, rate: Array, acceleration: Array, t: Array) -> Array:
    """Return the force on a wall (N,) [N] at times [s], given the penetration and its rates."""
    stiffness = wall.stiffness * (wall.factor(t) if wall.factor else 1.0)
    force = stiffness * delta + wall.damping * rate
    if wall.exponent == wall.exponent:
        depth = np.maximum(delta, 0.0) / wall.depth
        force = depth**wall.exponent * (stiffness * wall.depth + wall.damping * rate)
    force = force + wall.mass * acceleration + wall.friction * np.tanh(rate / _SIGN_VELOCITY)
    return np.where(delta > 0.0, np.maximum(force, 0.0), 0.0)


def low_pass(sensor: Sensor, force: Array) -> Array:
    """Filter a force at FINE; p poles of cutoff f delay slow forces by sqrt(p) / (2 pi f)."""
    cutoff = sqrt(sensor.poles) / (2.0 * pi * sensor.lag_s)
    return np.asarray(lfilter(*butter(sensor.poles, cutoff, fs=FINE), force))


def simulate(
    group: str, parameters: Mapping[str, Any], pieces: Sequence[Piece], seconds: float, wall: Wall,
    sensor: Sensor, draw: np.random.Generator, marks: Mapping[str, float] | None = None,
) -> World:
    """Simulate some seconds of a world along pieces of a path relative to `wall.location`."""
    t = np.arange(round(seconds * FINE)) / FINE
    path = path_at(pieces, t)
    inside = path - wall.shift(t) if wall.shift else path
    pressing = pressing_force(wall, inside[0], inside[1], inside[2], t)
    wrenches, motions = _measured(t, path, pressing, wall.location, sensor, draw)
    return World(group, parameters, wrenches, motions,
                 _truth(t, inside[0], pressing, wall, sensor), marks or {})


def _measured(
    t: Array, path: Array, pressing: Array, location: float, sensor: Sensor,
    draw: np.random.Generator,
) -> tuple[Stream, Stream]:
    sensed = -low_pass(sensor, pressing) - sensor.tool_mass * path[2] + sensor.zero
    at = np.arange(1, int(t[-1] * sensor.rate)) / sensor.rate
    count = len(at)
    force = np.interp(at, t, sensed) + sensor.noise * draw.standard_normal(count)
    x = location + np.interp(at, t, path[0])
    x += sensor.position_noise * draw.standard_normal(count)
    x = _POSITION_STEP * np.round(x / _POSITION_STEP)
    v = np.interp(at, t, path[1]) + sensor.velocity_noise * draw.standard_normal(count)
    return _stamped(at, force[:, None], draw), _stamped(at, np.column_stack([x, v]), draw)


def _stamped(t: Array, values: Array, draw: np.random.Generator) -> Stream:
    """Stamp with an error, and lose some."""
    errors = _STAMP_STD * draw.standard_normal(len(t))
    stamp_ns = EPOCH_NS + np.round((t + errors) * 1e9).astype(np.int64)
    kept = draw.uniform(size=len(t)) >= _LOST
    return Stream(t[kept], stamp_ns[kept], values[kept])


def _truth(t: Array, delta: Array, pressing: Array, wall: Wall, sensor: Sensor) -> Truth:
    every = round(FINE / 1000.0)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], delta > 0.0, [False]])))
    contacts = [(float(t[a]), float(t[b - 1])) for a, b in zip(edges[::2], edges[1::2])]
    t, delta, pressing = t[::every], delta[::every], pressing[::every]
    stiffness = wall.stiffness * (wall.factor(t) if wall.factor else np.ones_like(t))
    damping = np.full_like(t, wall.damping)
    if wall.exponent == wall.exponent:
        share = _recent_mean(delta) / wall.depth
        stiffness = stiffness * share**(wall.exponent - 1.0)
        damping = damping * share**wall.exponent
    return Truth(t, pressing, stiffness, damping, contacts, wall, sensor)


def _recent_mean(delta: Array) -> Array:
    """Return the exponential mean of the penetration in contact, kept between contacts."""
    gain = 1e-3 / _MEAN_DEPTH_S
    mean = np.full_like(delta, 1e-9)
    inside = delta > 0.0
    begun = lfilter([gain], [1.0, gain - 1.0], np.ones(int(inside.sum())))
    mean[inside] = lfilter([gain], [1.0, gain - 1.0], delta[inside]) / begun
    last = np.maximum.accumulate(np.where(inside, np.arange(len(delta)), 0))
    return np.asarray(mean[last])
