# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Compensation of known effects in the relation that an estimator fits.

With the (linear) operator S of the force sensor, contact c with the known surface and
acceleration a, the measured force obeys

    -F_measured = K_e S[c phi_K] + B_e S[c v] + S[c R] + S[mass a]

where K_e multiplies phi_K and R contains all known forces: K_e and B_e are the tangent at d = 0,
long-term, at t = 0.
"""

from collections import deque
import math
from math import nan
from typing import Any, Sequence

from .effect import Effect
from .force_delay import ForceDelay
from .force_sensor_effect import ForceSensorEffect
from .known_wall import KnownWall, Memory, Motion, NOT_FINITE, WAITING, WallTerms
from ..signals.contact_sample import CompensatedSample, ContactSample

_CLIPPED = 4.0  # standard deviations below the range of a sensor, beyond which it may clip
_REGULAR = 0.5, 1.5  # sample periods between samples over which motion is differentiated
_NOMINAL = 10  # samples that the nominal sample period counts as
_AVERAGED = 100  # samples over which the sample period is averaged
_LONGEST = 40.0  # sample periods that a gap counts in the average; bursts of stamps are shorter
_SLOW_S, _MOST_APART = 0.01, 50  # between positions that tell a slow acceleration, in samples

IRREGULAR = 'stamps too irregular for the acceleration that physics needs'
CLIPPED = 'the force is at the end of the range of the sensor'


class Compensation:
    """
    Evaluates known effects sample by sample.

    With an effect that replaces K_e, K_hat stays at the first guess; with one that replaces B_e,
    B_hat is 0. Effects of the robot have no influence. Effects of the sensor act from the first
    sample on, those of the wall as soon as its surface is known.

    initial_stiffness: first guess of K_e [N/m]
    force_noise: standard deviation of the force noise [N]
    sample_rate: nominal [Hz], until the stamps have shown theirs
    late: delays a signal as the sensor does, given time, time step [s] and value
    """

    def __init__(
        self, effects: Sequence[Effect], initial_stiffness: float, force_noise: float,
        sample_rate: float,
    ) -> None:
        self._sensor = [one for one in effects if isinstance(one, ForceSensorEffect)]
        lagging = [effect for effect in self._sensor if 'reader' in effect.changes]
        self._wall = KnownWall(
            effects, initial_stiffness, (lambda: _memory(lagging)) if lagging else None)
        self._tool = sum(effect.added_mass for effect in self._sensor)
        self._late, self.lags = _memory(lagging), bool(lagging)
        self.late = _memory([effect for effect in lagging if isinstance(effect, ForceDelay)])
        self._moves = self._wall.inertia > 0.0 or self._tool > 0.0
        self._range = min((e.largest_reading for e in self._sensor), default=math.inf)
        self._range -= _CLIPPED * force_noise
        self._first_ns = 0
        self._last: Motion | None = None
        self._speed = nan  # between the last two samples [m/s]
        self._before = nan  # measured at the sample before the last [m/s]
        self._period, self._count = 1.0 / sample_rate, _NOMINAL  # mean period [s], and of how many
        self._forces: deque[float] = deque(maxlen=3)
        self._path: deque[tuple[float, float]] = deque(maxlen=2 * _MOST_APART + 1)  # t [s], x [m]

    @property
    def inertia(self) -> float:
        """M_e of the wall and mass of the tool [kg]."""
        return self._wall.inertia + self._tool

    @property
    def acts(self) -> bool:
        """Whether there is anything to compensate."""
        return self._wall.acts or bool(self._sensor)

    def nominal(self, surface: float) -> float:
        """Return x_e nominal of a wall first met at some place; see `KnownWall.nominal`."""
        return self._wall.nominal(surface)

    def take(self, sample: ContactSample, location: float, pressing: float) -> CompensatedSample:
        """Process a sample, with x_e nominal [m], NaN until known, and -F_e less the tare [N]."""
        now, regular = self._motion(sample)
        terms = self._wall.take(now, location)
        tool = self._late(now.t, now.dt, self._tool * now.acceleration)
        hindrance = '' if regular or not self._moves else IRREGULAR
        if not abs(sample[3]) < self._range:
            hindrance = CLIPPED
        measured = pressing
        for effect in reversed(self._sensor):
            pressing = -effect.undo(now.t, -pressing)
        if pressing - pressing != 0.0:  # not finite
            pressing, hindrance = measured, NOT_FINITE
        self._forces.append(pressing)
        if not self._moves:
            depth, R, _, travel, v, column, slope, hindered = terms[-1]
            return CompensatedSample(depth, pressing + self._wall.free_force, pressing - R, travel,
                                     v, column, slope, 0.0, hindered or hindrance)
        felt = pressing + self._wall.free_force - self._tool * self._slow_acceleration(now)
        return self._averaged(terms, felt, tool, hindrance)

    def _slow_acceleration(self, now: Motion) -> float:
        """Return an acceleration that does not hide a touch in its noise [m/s^2]."""
        if now.velocity == now.velocity or not self._tool:
            return now.acceleration
        path, apart = self._path, min(max(round(_SLOW_S / self._period), 1), _MOST_APART)
        path.append((now.t, now.x))
        if len(path) <= 2 * apart:
            return 0.0
        (t_0, x_0), (t_1, x_1), (t_2, x_2) = (path[-1 - k * apart] for k in (2, 1, 0))
        least, most = (apart * self._period * bound for bound in _REGULAR)
        if not (least < t_1 - t_0 < most and least < t_2 - t_1 < most):
            return 0.0
        return 2.0 * ((x_2 - x_1) / (t_2 - t_1) - (x_1 - x_0) / (t_1 - t_0)) / (t_2 - t_0)

    def _motion(self, sample: ContactSample) -> tuple[Motion, bool]:
        """Return the motion, and whether its acceleration is known."""
        stamp_ns, x, velocity, _ = sample
        if velocity - velocity != 0.0:
            velocity = nan
        last = self._last
        if last is None:
            self._first_ns = stamp_ns
            rate = 0.0 if velocity != velocity else velocity
            self._last = now = Motion(0.0, 0.0, x, velocity, rate, 0.0, 0.0)
            return now, False
        t = (stamp_ns - self._first_ns) * 1e-9
        dt = t - last.t
        periods = self._periods(dt)
        least, most = _REGULAR
        speed = (x - last.x) / dt if periods > least else nan  # else it is noise alone
        rate = velocity
        if rate != rate:  # a smoothed rate would be delayed, and with it the reversal of friction
            rate = speed if speed == speed else last.rate
        a, both = 0.0, dt + last.dt
        regular = least < periods < most and least < last.periods < most
        if regular:
            rise = velocity - self._before
            a = rise / both if rise == rise else 2.0 * (speed - self._speed) / both
            if a - a != 0.0:  # not finite
                a, regular = 0.0, False
        self._before = last.velocity
        self._speed = speed
        self._last = now = Motion(t, dt, x, velocity, rate, a, periods)
        return now, regular

    def _periods(self, dt: float) -> float:
        """Return the number of mean sample periods in a time."""
        if dt <= 0.0:
            return 0.0
        mean = self._period
        self._count = min(self._count + 1, _AVERAGED)
        self._period = mean + (min(dt, _LONGEST * mean) - mean) / self._count
        return dt / self._period

    def _averaged(
        self, terms: Sequence[WallTerms], pressing: float, tool: float, hindrance: str
    ) -> CompensatedSample:
        """Average the last three samples with the weights of eq. (31)."""
        # The average matches a central difference over the same samples, which is neither delayed
        # against it nor as noisy as an acceleration at the newest sample.
        first, middle, last = (terms[k] for k in (0, len(terms) // 2, -1))
        forces = self._forces
        f_0, f_1, f_2 = (forces[k] for k in (0, len(forces) // 2, -1))
        R, _, travel, v, column, slope = (
            0.25 * (a + b + b + c) for a, b, c in zip(first[1:7], middle[1:7], last[1:7]))
        rest = 0.25 * (f_0 + f_1 + f_1 + f_2) - R - last.inertial_force - tool
        hindrance = last.hindrance or hindrance or middle.hindrance or first.hindrance
        if not hindrance and len(terms) < 3:
            hindrance = WAITING
        return CompensatedSample(last.depth, pressing, rest, travel, v, column, slope,
                                 last.inertial_force + tool, hindrance)


def _memory(effects: Sequence[Any]) -> Memory:
    """Return the dynamic part of a sensor as a filter for one signal."""
    readers = [effect.reader() for effect in effects]

    def sense(t: float, dt: float, value: float) -> float:
        for read in readers:
            value = read(t, dt, value, 0.0)
        return value

    return sense
