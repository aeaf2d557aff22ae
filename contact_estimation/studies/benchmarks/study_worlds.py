# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Worlds of the estimators study, as real sensors and robots are, and peers of other packages."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any, Callable, Iterator, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, lfilter

from ...estimators.parameters import EnvironmentParameters
from ...exceptions import MissingPackageError
from ...physics.prior import log_uniform
from ...signals.contact_sample import ContactSample
from ...signals.synchronisation import SynchronisationParameters, Synchroniser


Array = NDArray[np.float64]

RATE = 500.0
SOFTEST, STIFFEST = 300.0, 1e5
_FINE = 10_000.0  # rate at which force and filter of the sensor are computed [Hz]
_FREE_S, _APPROACH_S, _BETWEEN_S = 1.0, 0.5, 0.6
_GAP = 5e-3  # of the tool from the wall in free flight [m]
_DEEPEST = 0.03  # [m]
_PRIOR_STD = EnvironmentParameters().location_std
_FARTHEST = 3.0  # standard deviations of x_e: as far as a surface is looked for
_JITTER_S = 1e-4
_DROPPED = 0.002
_POSITION_STEP = 1e-6  # [m]
_VELOCITY_NOISE = 1e-4  # [m/s]
_FORCE_STEP = 0.02  # [N]


@dataclass(frozen=True)
class Scenario:
    """What happens in a world."""

    name: str  # of the scenario
    # whether the tool moves while pressing; None: in every second world
    excited: bool | None = True
    contacts: int = 2  # number of contacts
    hold_s: float = 4.0  # duration of each [s]
    # stiffness of the wall in each contact [N/m]; (): drawn, the same in all
    walls: tuple[float, ...] = ()
    # stiffness over time since the touch-down [s], relative to that of the wall
    factor: Callable[[Array], Array] | None = None
    # when it changes, after the touch-down; 0 for a wall that is new in the last contact [s]
    change_s: float = 0.0
    location_std: float = 0.0  # of the true x_e about that of the parameters [m]; 0: exact
    exact_location: bool = False  # whether the parameters say that x_e is exact
    abrupt: bool = False  # whether there is a change from which estimates converge again
    # force on the wall before it is clipped at 0, where it is not that of a spring and damper
    pressing: Callable[[Course, Sensor], Array] | None = None


def _step(t: Array) -> Array:
    return np.where(t < 2.0, 1.0, 2.0)


def _ramp(t: Array) -> Array:
    return 1.0 + 0.5 * np.clip((t - 1.0) / 10.0, 0.0, 1.0)


SCENARIOS = {
    scenario.name: scenario for scenario in (
        Scenario('excited', exact_location=True),
        Scenario('unexcited', excited=False, exact_location=True),
        Scenario('excited, x_e within 2 mm', location_std=_PRIOR_STD),
        Scenario('unexcited, x_e within 2 mm', excited=False, location_std=_PRIOR_STD),
        Scenario('300 to 30000 N/m', excited=None, hold_s=3.0, walls=(300.0, 3e4),
                 abrupt=True),
        Scenario('30000 to 300 N/m', excited=None, hold_s=3.0, walls=(3e4, 300.0),
                 abrupt=True),
        Scenario('step x 2', contacts=1, hold_s=6.0, factor=_step, change_s=2.0, abrupt=True),
        Scenario('ramp 50 % in 10 s', contacts=1, hold_s=11.0, factor=_ramp, change_s=1.0),
    )
}

STEADY = tuple(name for name, scenario in SCENARIOS.items()
               if not scenario.walls and scenario.factor is None)
"""Scenarios in which the wall stays the same."""


class Sensor(NamedTuple):
    """
    Force sensor with a low-pass filter, and whether the robot measures its velocity.

    One pole delays the force by 1 / (2 pi cutoff), two (Butterworth) by sqrt(2) times that: 0.5
    to 2.3 ms, in the root mean square the 1 ms of `synchronisation.timing_std`.
    """

    cutoff: float  # cut-off frequency of the low-pass filter [Hz]
    noise: float  # standard deviation of the force noise [N]
    with_velocity: bool  # whether `joint_states` carry velocities
    poles: int = 1  # 1 or 2, order of the low-pass filter


class World(NamedTuple):
    """The samples of a world with the truth."""

    scenario: Scenario  # what happens
    samples: list[ContactSample]  # as paired by the synchroniser
    t: Array  # (N,) their stamps [s]
    # stiffness, damping (N,): K_e [N/m] and B_e [N s/m] of the wall
    stiffness: Array
    damping: Array
    contacts: list[tuple[float, float]]  # begin and end of the true contacts [s]
    sensor: Sensor  # that measured the force


class Course(NamedTuple):
    """The path of the tool and the wall at a high rate."""

    t: Array  # (N,) time [s]
    # delta, rate (N,): penetration [m] and its rate [m/s]
    delta: Array
    rate: Array
    # stiffness, damping (N,): K_e [N/m] and B_e [N s/m]
    stiffness: Array
    damping: Array
    contacts: list[tuple[float, float]]  # begin and end of each [s]


def make_world(scenario: Scenario, index: int, count: int, seed: int) -> World:
    """Draw and simulate one world."""
    key = list(SCENARIOS).index(scenario.name) if scenario.name in SCENARIOS else 99
    draw = np.random.default_rng([seed, key, index])
    excited = index % 2 == 0 if scenario.excited is None else scenario.excited
    K = SOFTEST * (STIFFEST / SOFTEST) ** ((index + draw.uniform()) / count)
    seconds = log_uniform(draw, 2e-3, 5e-2)  # B_e / K_e
    path = _path(scenario, K, seconds, excited, draw)
    sensor = Sensor(draw.uniform(100.0, 300.0), log_uniform(draw, 0.1, 0.5), index % 4 < 2,
                    int(draw.integers(1, 3)))
    off = scenario.location_std * float(np.clip(draw.standard_normal(), -_FARTHEST, _FARTHEST))
    law = scenario.pressing or _spring_and_damper
    samples = [sample._replace(position=sample.position + off)
               for sample in _measure(path, law(path, sensor), sensor, draw)]
    t = np.array([sample.stamp_ns for sample in samples]) * 1e-9
    return World(scenario, samples, t, np.interp(t, path.t, path.stiffness),
                 np.interp(t, path.t, path.damping), path.contacts, sensor)


def _path(
    scenario: Scenario, drawn: float, seconds: float, excited: bool, draw: np.random.Generator
) -> Course:
    """Approach, press and withdraw once for each contact, between stretches of free flight."""
    pieces, contacts, begin = [], [], 0.0
    for contact in range(scenario.contacts):
        K = scenario.walls[contact] if scenario.walls else drawn
        depth = min(draw.uniform(20.0, 60.0) / K, _DEEPEST)
        free = _FREE_S if contact == 0 else _BETWEEN_S
        length = free + 2.0 * _APPROACH_S + scenario.hold_s
        t = np.arange(round(length * _FINE)) / _FINE
        delta = _press(t - free, depth, scenario.hold_s)
        if excited:
            delta += depth * _excitation(t - free - _APPROACH_S, scenario.hold_s, draw)
        touch = float(t[np.argmax(delta > 0.0)])
        factor = scenario.factor(t - touch) if scenario.factor else np.ones_like(t)
        inside = t[delta > 0.0]
        contacts.append((begin + touch, begin + float(inside[-1])))
        pieces.append(np.array([t + begin, delta, K * factor, np.full_like(t, K * seconds)]))
        begin += length
    t, delta, stiffness, damping = np.concatenate(pieces, axis=1)
    return Course(t, delta, np.gradient(delta, 1.0 / _FINE), stiffness, damping, contacts)


def _press(t: Array, depth: float, hold_s: float) -> Array:
    """Move in from the gap to a depth along a quintic, hold, and back."""
    into = np.clip(t / _APPROACH_S, 0.0, 1.0)
    out = np.clip((t - _APPROACH_S - hold_s) / _APPROACH_S, 0.0, 1.0)
    share = _quintic(into) - _quintic(out)
    return np.asarray(-_GAP + (_GAP + depth) * share)


def _quintic(s: Array) -> Array:
    return np.asarray(s**3 * (10.0 - 15.0 * s + 6.0 * s**2))


def _excitation(t: Array, hold_s: float, draw: np.random.Generator) -> Array:
    """Three sines of 1 to 8 Hz, faded in and out, together at most a third of the depth."""
    fade = np.clip(np.minimum(t, hold_s - t) / 0.3, 0.0, 1.0)
    frequencies, phases = draw.uniform(1.0, 8.0, 3), draw.uniform(0.0, 2.0 * pi, 3)
    waves = np.sin(2.0 * pi * frequencies[:, None] * t + phases[:, None])
    return np.asarray(_quintic(fade) * waves.sum(axis=0) / 9.0)


def _spring_and_damper(path: Course, sensor: Sensor) -> Array:
    pressing = path.stiffness * path.delta + path.damping * path.rate
    return np.where(path.delta > 0.0, pressing, 0.0)


def _measure(
    path: Course, pressing: Array, sensor: Sensor, draw: np.random.Generator
) -> list[ContactSample]:
    """Measure at the nominal times, stamp with an error, lose some, and pair."""
    low_pass = butter(sensor.poles, sensor.cutoff, fs=_FINE)
    sensed = lfilter(*low_pass, np.maximum(pressing, 0.0))
    t = np.arange(1, int(path.t[-1] * RATE)) / RATE
    force = np.interp(t, path.t, sensed) + sensor.noise * draw.standard_normal(len(t))
    force = _FORCE_STEP * np.round(force / _FORCE_STEP)
    # Position 0 is the wall; a random origin of the quantisation.
    origin = draw.uniform() * _POSITION_STEP
    position = np.interp(t, path.t, path.delta)
    position = _POSITION_STEP * np.round((position + origin) / _POSITION_STEP) - origin
    velocity = np.interp(t, path.t, path.rate) + _VELOCITY_NOISE * draw.standard_normal(len(t))
    if not sensor.with_velocity:
        velocity = np.full_like(velocity, np.nan)
    return _paired(t, position, velocity, -force, draw)


def _paired(
    t: Array, position: Array, velocity: Array, force: Array, draw: np.random.Generator
) -> list[ContactSample]:
    events = []
    for kind, columns in ((0, (position, velocity)), (1, (force,))):
        stamps = np.round((t + _JITTER_S * draw.standard_normal(len(t))) * 1e9).astype(np.int64)
        kept = draw.uniform(size=len(t)) >= _DROPPED
        rows = zip(stamps[kept].tolist(), *(column[kept].tolist() for column in columns))
        events += [(row[0], kind, row[1:]) for row in rows]
    synchroniser = Synchroniser(SynchronisationParameters())
    samples = []
    for stamp_ns, kind, values in sorted(events, key=lambda event: event[:2]):
        add = synchroniser.add_wrench if kind else synchroniser.add_motion
        samples += [axes[0] for axes in add(stamp_ns, values)]
    return samples


Trace = tuple[Array, Array, Array, Array]
"""K_hat, B_hat and their standard deviations at each sample, shape (N,) each."""

_TOUCH = 6.0  # standard deviations of the force noise above which the peers update
_START = np.array([3000.0, 50.0])
_START_STD = np.array([1e5, 1e4])
_WALK = 0.02  # of filterpy's state relative to its values [1/sqrt(s)]
_MEMORY = 0.998  # forgetting factor of padasip: one second


def filterpy_kalman(world: World) -> Trace:
    """Estimate by filterpy's Kalman filter for (K_e, B_e) with a random walk."""
    from filterpy.kalman import KalmanFilter

    variance = _noise_variance(world)
    kalman = KalmanFilter(dim_x=2, dim_z=1)
    kalman.x, kalman.P = _START[:, None].copy(), np.diag(_START_STD**2)

    def update(y: float, phi: Array) -> None:
        walk = _WALK * np.maximum(np.abs(kalman.x[:, 0]), _START / 10.0)
        kalman.predict(Q=np.diag(walk**2 / RATE))
        kalman.update(y, R=variance, H=phi[None, :])

    return _traced(world, update, lambda: (kalman.x[:, 0], np.diag(kalman.P)))


def padasip_rls(world: World) -> Trace:
    """Estimate by padasip's recursive least squares with forgetting."""
    try:
        from padasip.filters import FilterRLS
    except ImportError as error:
        raise MissingPackageError.of('padasip', 'a peer of the estimators study') from error

    variance = _noise_variance(world)
    rls: Any = FilterRLS(2, mu=_MEMORY, eps=1.0 / _START_STD[0]**2, w=_START.tolist())

    def update(y: float, phi: Array) -> None:
        rls.adapt(y, phi)

    return _traced(world, update, lambda: (rls.w, variance * np.diag(rls.R)))


PEERS: dict[str, Callable[[World], Trace]] = {
    'filterpy Kalman, bare': filterpy_kalman,
    'padasip RLS, bare': padasip_rls,
}


def _noise_variance(world: World) -> float:
    free = world.t < 0.9 * world.contacts[0][0]
    forces = np.array([sample.force for sample in world.samples])
    return float(np.var(forces[free]))


def _rows(world: World) -> Iterator[tuple[float, float, Array]]:
    """Yield pressing force and (delta, v); v from differences where it is not measured."""
    last = world.samples[0]
    for now in world.samples:
        v = now.velocity
        if v != v:
            dt = (now.stamp_ns - last.stamp_ns) * 1e-9
            v = (now.position - last.position) / dt if dt > 0.0 else 0.0
        last = now
        yield -now.force, now.position, np.array([now.position, v])


def _traced(
    world: World, update: Callable[[float, Array], None],
    state: Callable[[], tuple[Array, Array]],
) -> Trace:
    touch = _TOUCH * np.sqrt(_noise_variance(world))
    values = []
    for pressing, position, phi in _rows(world):
        if pressing > touch and position > 0.0:
            update(pressing, phi)
        theta, variances = state()
        values.append((*theta, *np.sqrt(np.maximum(variances, 0.0))))
    columns = np.array(values).T
    return columns[0], columns[1], columns[2], columns[3]
