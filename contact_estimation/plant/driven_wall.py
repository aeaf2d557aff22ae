# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A permanently attached environment without a robot, driven by a recorded force."""

import bisect
import math
from math import ceil, sqrt
from typing import Callable

import numpy as np

from .plant_parameters import PlantParameters
from .world import combine, shift, State
from ..exceptions import ParameterRangeError, SignalShapeError
from ..physics import effects_that_are_on
from ..physics.contact_law import ContactLaw
from ..physics.effect import Effect
from ..physics.force_sensor_effect import ForceSensorEffect
from ..physics.numeric import Array
from ..reference.setpoints import Reference, ReferenceAt

_AHEAD, _HERE = 11.0 / 60.0, 1.0 - 22.0 / 60.0  # weights of neighbours and middle
_POLE = (sqrt(_HERE**2 - 4.0 * _AHEAD**2) - _HERE) / (2.0 * _AHEAD)
_GAIN = -_POLE / _AHEAD


def straight(force: Array) -> Array:
    """Return the samples, shape (N,), of a linearly interpolated force: the force itself."""
    return force


def smooth(force: Array) -> Array:
    """Return the samples of a smooth curve through the force; parameters as `straight`."""
    # A tone's area over an interval is tan(u) / u times that under the line, u = omega h / 2. With
    # q = sin(u)^2, which is -1/4 of the second difference, it is 1 + q / 3 / (1 - 11 q / 15) to a
    # hundredth for four samples a period or more (a compact scheme, Lele 1992).
    from scipy.signal import lfilter  # slow to import, and no node needs it

    bend = np.zeros(len(force))
    bend[1:-1] = np.diff(force, 2) / -12.0
    forward = lfilter([_GAIN], [1.0, -_POLE], bend)
    return force + np.asarray(lfilter([1.0], [1.0, -_POLE], forward[::-1])[::-1])


def held(force: Array) -> Array:
    """Return the samples of a force held until the next; parameters as `straight`."""
    # The line through the centres of the steps, delayed by half a sample.
    late = force.copy()
    late[1:] = 0.5 * (force[1:] + force[:-1])
    return late


BETWEEN: dict[str, Callable[[Array], Array]] = {
    'straight': straight, 'smooth': smooth, 'held': held,
}
"""Behaviour between samples by name, the most likely first."""

NOISE = {'straight': (1.0,), 'smooth': (-1.0 / 12.0, 7.0 / 6.0, -1.0 / 12.0), 'held': (0.5, 0.5)}
"""Filter weights of each for white noise of the samples, `smooth` to first order."""


def reference_through(t: Array, rows: Array, held: bool = False) -> ReferenceAt:
    """Continue a reference (4, N) of times (N,) [s] by lines, or held; outside it rests."""
    if np.ndim(t) != 1 or len(t) < 1 or np.shape(rows) != (4, len(t)):
        raise SignalShapeError(
            'a reference needs t of shape (N,) and rows of shape (4, N) with N >= 1, got '
            f'{np.shape(t)} and {np.shape(rows)}; give x_r, its rate, its acceleration and F_r')
    if not np.all(np.diff(t) > 0.0):
        raise SignalShapeError(
            'the times of a reference must increase strictly, got equal or decreasing ones; '
            'sort the samples and keep one per time')
    times: list[float] = t.tolist()
    points: list[tuple[float, float, float, float]] = list(zip(*rows.tolist()))
    slopes = list(zip(*((0.0 if held else 1.0) * np.diff(rows) / np.diff(t)).tolist()))
    before, after = (Reference(points[k][0], 0.0, 0.0) for k in (0, -1))
    begin, end, place = times[0], times[-1], 0

    def at(now: float) -> tuple[float, float, float, float]:
        nonlocal place
        if not begin <= now < end:
            return before if now < begin else after if now > end else points[-1]
        if not times[place] <= now < times[place + 1]:
            place = bisect.bisect_right(times, now) - 1
        since, (x, v, a, F) = now - times[place], points[place]
        x_1, v_1, a_1, F_1 = slopes[place]
        return x + since * x_1, v + since * v_1, a + since * a_1, F + since * F_1

    return at


def run_driven_wall(
    parameters: PlantParameters, t: Array, force: Array, x0: float, v0: float = 0.0,
    begin: float = 0.0,
) -> Array:
    """
    Simulate the environment under a measured force (N,) [N] at times (N,) [s]; return x (N,) [m].

    M_e xdd = -F_e - (B_e v + K_e delta + physics), the force interpolated linearly and
    corrected for the effects of the sensor.

    begin: the wall's time at t[0] [s], on which some effects depend
    """
    return run_driven_wall_with_rates(parameters, t, force, x0, v0, begin)[0]


def run_driven_wall_with_rates(
    parameters: PlantParameters, t: Array, force: Array, x0: float, v0: float = 0.0,
    begin: float = 0.0,
) -> Array:
    """Return x [m], v and a, shape (3, N); parameters as `run_driven_wall`."""
    if np.shape(t) != np.shape(force) or np.ndim(t) != 1 or len(t) < 2:
        raise SignalShapeError(
            'a driven wall needs t and force of one shape (N,) with N >= 2, got '
            f'{np.shape(t)} and {np.shape(force)}')
    wall = DrivenWall(parameters)
    since = t - t[0] + begin
    return wall.run(since, wall.true_force(since, force), (x0, v0))


class DrivenWall:
    """The attached environment, integrated by fourth-order Runge-Kutta steps."""

    def __init__(self, parameters: PlantParameters) -> None:
        wall = parameters.environment
        if wall.unilateral:
            raise ParameterRangeError(
                'only a wall that is permanently attached follows a force alone, got '
                'environment.unilateral true; set it to false, or give a reference_trajectory')
        effects: list[Effect] = effects_that_are_on(parameters.physics, parameters.sign_velocity)
        self._sensor = [e for e in effects if isinstance(e, ForceSensorEffect)]
        self._law = ContactLaw(
            wall.stiffness, wall.damping, wall.location, wall.inertia, False, effects)
        # A mass between sensor and wall moves with the wall, driven by the measured force.
        self._mass = self._law.inertia + sum(effect.added_mass for effect in self._sensor)
        if self._mass <= 0.0:
            raise ParameterRangeError(
                'environment.inertia must be > 0 kg for an attached wall without a robot, got '
                f'{wall.inertia:g}; without mass the force does not determine the motion')
        self._rate = parameters.integration_rate

    def true_force(self, t: Array, reading: Array) -> Array:
        """Remove the effects of the sensor, except for its mass, from a reading (N,) [N]."""
        for effect in reversed(self._sensor):
            reading = effect.undo_along(t, reading)
        return reading

    def run(self, t: Array, force: Array, start: tuple[float, float]) -> Array:
        """Integrate under F_e (N,) [N] at times (N,) [s] from (x, v); return x, v, a, (3, N)."""
        state: State = (*start, *(0.0,) * self._law.states)
        times, forces = t.tolist(), force.tolist()
        motion = [(*state[:2], self._acceleration(times[0], state, forces[0]))]
        for now, then, f, g in zip(times[:-1], times[1:], forces[:-1], forces[1:]):
            steps = max(1, ceil((then - now) * self._rate - 1e-6))
            h, slope = (then - now) / steps, (g - f) / steps
            for k in range(steps):
                state = self._step(now + k * h, state, h, f + k * slope, slope)
            motion.append((*state[:2], self._acceleration(then, state, g)))
        return np.array(motion).T

    def _step(self, t: float, state: State, h: float, force: float, slope: float) -> State:
        half, middle = 0.5 * h, force + 0.5 * slope
        k1 = self._rates(t, state, force)
        k2 = self._rates(t + half, shift(state, half, k1), middle)
        k3 = self._rates(t + half, shift(state, half, k2), middle)
        k4 = self._rates(t + h, shift(state, h, k3), force + slope)
        x, v, *states = combine(state, h, k1, k2, k3, k4)
        if not states:
            return x, v
        return (x, v, *self._law.settle(t + h, x, v, tuple(states)))

    def _rates(self, t: float, state: State, force: float) -> State:
        a = self._acceleration(t, state, force)
        if len(state) == 2:
            return state[1], a
        return (state[1], a, *self._law.rates(t, state[0], state[1], state[2:]))

    def _acceleration(self, t: float, state: State, force: float) -> float:
        resistance = self._law.resistance(t, state[0], state[1], state[2:], math)
        return float(-force - resistance) / self._mass
