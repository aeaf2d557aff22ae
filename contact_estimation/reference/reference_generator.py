# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The reference trajectory x_r, continuous under jumps of estimate and setpoint."""

from math import copysign, inf, isfinite
from typing import Callable

from .parameters import ReferenceParameters, refuse_double_tracking
from .setpoints import Desired, Reference


def quintic(start: float, end: float, duration: float, t: float) -> tuple[float, float, float]:
    """Return x [m] and its rates on the quintic from rest to rest at a time [s], clipped."""
    s = min(max(t / duration, 0.0), 1.0)
    span = end - start
    return (
        start + span * s**3 * (10.0 - 15.0 * s + 6.0 * s * s),
        span / duration * 30.0 * s * s * (1.0 - s) ** 2,
        span / duration**2 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s))


Compliance = Callable[[float, float], float]


def eq20_compliance(K_hat: float, K_t: float) -> float:
    """Eq. (20), x_r = x_e + F_r / K_hat: return (x_r - x_e) / F_r [m/N]."""
    return 1.0 / K_hat


def series_compliance(K_hat: float, K_t: float) -> float:
    """Springs in series, x_r = x_e + F_r (1 / K_hat + 1 / K_t): return (x_r - x_e) / F_r [m/N]."""
    return 1.0 / K_hat + 1.0 / K_t


LAWS: dict[str, Compliance | None] = {
    'eq20': eq20_compliance,
    'series': series_compliance,
    'pass_through': None,
}
"""Compliance by name of the law; None: x_d passes through, whatever F_r is."""

_new = tuple.__new__  # of a named tuple: half the time of a call of its class


class ReferenceGenerator:
    """
    Convert setpoints of the planner into the reference that the robot follows.

    A force law applies while F_r is finite and there is contact; otherwise x_d passes through.
    Whenever that changes, the offset between old and new reference fades out smoothly. Position
    and rates always stay within the limits of `limited`.

    period_s: nominal time between references [s]
    limited: whether a limit keeps the last reference away from what it should be
    """

    def __init__(self, law: str, parameters: ReferenceParameters, period_s: float = 2e-3) -> None:
        self._law, self._p, self._period_s = law, parameters, period_s
        refuse_double_tracking(law, parameters.robot_force_tracking)
        self.reset()

    def reset(self) -> None:
        """Discard the past: the next reference is not smoothed, unless `start` is called."""
        self._mode: str | None = None
        self._last: Reference | None = None
        self._offset, self._faded_s = 0.0, 0.0
        self._resting: Desired | None = None  # the setpoint at which x_r rests, without a force
        self.limited = False
        self._forces: list[tuple[float, float]] = []  # (time, F_r), at most three

    def start(self, position: float) -> None:
        """Start at the measured position [m], from which x_r then moves within its limits."""
        self._last, self._resting = Reference(position, 0.0, 0.0), None

    def configure(self, law: str, parameters: ReferenceParameters, period_s: float = 2e-3) -> None:
        """Change law or limits while running; x_r stays continuous."""
        refuse_double_tracking(law, parameters.robot_force_tracking)
        if law != self._law or parameters != self._p:
            self._mode = None if self._last is None else 'changed'
        self._law, self._p, self._period_s, self._resting = law, parameters, period_s, None

    def step(
        self, t: float, dt: float, desired: Desired, contact: bool, x_e: float, K_hat: float,
        deepest: float = inf,
    ) -> Reference:
        """Compute the reference of t [s], dt after the last; NaN: `deepest` [m] is no limit."""
        position, velocity, acceleration, force = desired
        last = self._last
        if desired is self._resting and last is not None and not position > deepest:
            return last
        mode, presses = 'pass_through', isfinite(force)
        F_r_dot = F_r_ddot = 0.0
        if presses or self._forces:
            F_r_dot, F_r_ddot = self._differentiate(t, force)
        compliance = LAWS[self._law] if contact and presses else None
        if compliance is None:
            target = _new(Reference, (position, velocity, acceleration, 0.0))
        else:
            mode, C = self._law, compliance(
                max(K_hat, self._p.stiffness_floor), self._p.robot_stiffness)
            target = Reference(x_e + force * C, F_r_dot * C, F_r_ddot * C, force)
        if mode != self._mode:
            self._switch(mode, dt, target)
        wanted = self._fade(dt, target) if self._offset else target
        if last is None:
            last = wanted
        if not isfinite(last[0]):
            last = Reference(0.0, 0.0, 0.0)
        new = limited(last, wanted, dt, self._period_s, self._p.maximum_velocity, deepest)
        self._last, self.limited = new, new[0] != wanted[0]
        self._resting = desired if new is target and not presses else None
        return new

    def _differentiate(self, t: float, F_r: float) -> tuple[float, float]:
        past = self._forces
        if not isfinite(F_r):
            if past:
                past.clear()
            return 0.0, 0.0
        if past and t <= past[-1][0]:
            past.clear()
        if past and abs(F_r - past[-1][1]) > self._p.maximum_force_rate * (t - past[-1][0]):
            past.clear()
        past.append((t, F_r))
        if len(past) < 3:
            return 0.0, 0.0
        (t2, f2), (t1, f1), (t0, f0) = past
        del past[0]
        slope, before = (f0 - f1) / (t0 - t1), (f1 - f2) / (t1 - t2)
        curvature = 2.0 * (slope - before) / (t0 - t2)
        return slope + 0.5 * curvature * (t0 - t1), curvature

    def _switch(self, mode: str, dt: float, target: Reference) -> None:
        if self._mode is not None and self._last is not None:
            # Extrapolate the old reference by its velocity, so that the rate is continuous too.
            expected = self._last.position + dt * self._last.velocity
            offset = expected - target.position
            self._offset, self._faded_s = offset if isfinite(offset) else 0.0, 0.0
        self._mode = mode

    def _fade(self, dt: float, target: Reference) -> Reference:
        duration = self._p.fade_s
        s = self._faded_s / duration
        self._faded_s += dt
        if s >= 1.0:
            self._offset = 0.0
            return target
        o = self._offset
        return Reference(
            target.position + o * (1.0 - s * s * (3.0 - 2.0 * s)),
            target.velocity - o * 6.0 * s * (1.0 - s) / duration,
            target.acceleration - o * (6.0 - 12.0 * s) / duration**2, target.force)


def limited(
    last: Reference, target: Reference, dt: float, period: float, speed: float, deepest: float
) -> Reference:
    """
    Return the reference that is nearest to a target within the limits.

    x_r is finite, moves at most `speed` dt from the last reference, and not deeper than
    `deepest` (NaN: no limit); from beyond it, x_r retreats at that speed. The same holds along the
    parabola that the robot follows for a period. Where the target is not finite, or dt not > 0,
    x_r stays.
    """
    position, velocity, acceleration, force = target
    before = last[0]
    if not isfinite(position):
        return Reference(before, 0.0, 0.0, force)
    if position > deepest:
        position, velocity, acceleration = deepest, 0.0, 0.0
    step, most = position - before, speed * dt if dt > 0.0 else 0.0
    if velocity == 0.0 == acceleration and abs(step) <= most and position == target[0]:
        return target  # at rest within all limits, the usual case
    if abs(step) > most:
        position = before + copysign(most, step)  # and on at the same rate, at most `speed`
        velocity, acceleration = copysign(min(speed, most / period), step), 0.0
    if velocity != 0.0 or acceleration != 0.0:
        velocity, acceleration = _rates(position, velocity, acceleration, period, speed, deepest)
    return Reference(position, velocity, acceleration, force)


def _rates(
    position: float, velocity: float, acceleration: float, period: float, speed: float,
    deepest: float,
) -> tuple[float, float]:
    """Return velocity and acceleration with which the limits hold until the next reference."""
    if not (isfinite(velocity) and isfinite(acceleration)):
        return 0.0, 0.0
    v = min(max(velocity, -speed), speed)
    reached = v + period * acceleration
    a = acceleration if v == velocity and abs(reached) <= speed else 0.0
    furthest = position + period * (v + max(0.5 * period * a, 0.0))
    if furthest > deepest:
        v, a = min(v, max(0.0, (deepest - position) / period)), 0.0
    return v, a
