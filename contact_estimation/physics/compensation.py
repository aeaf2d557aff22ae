# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""
Compensation of known effects in the relation that an estimator fits.

With the (linear) operator S of the force sensor, contact c with the known surface and
acceleration a, the measured force obeys

    -F_measured = K_e S[c phi_K] + B_e S[c v] + S[c R] + S[mass a]

where K_e multiplies phi_K and R contains all known forces: K_e and B_e are the tangent at d = 0,
long-term, at t = 0.
"""

from __future__ import annotations

from collections import deque
import math
from math import nan
from typing import Any, Callable, NamedTuple, Sequence

from .contact_law import ContactLaw
from .effect import Effect
from .force_sensor_effect import ForceSensorEffect
from ..signals.compensated_sample import CompensatedSample

_STEPS = 4  # integration steps of internal states per sample
_NEAR = 1e-7  # step of the difference quotient of phi_K [m]
_CLIPPED = 4.0  # standard deviations below the range of a sensor, beyond which it may clip
State = tuple[float, ...]
Memory = Callable[[float, float, float], float]  # time, time step, value -> value


class _Past(NamedTuple):
    """Motion at a sample, and its known quantities without inertia."""

    depth: float
    velocity: float
    contact: float
    known: CompensatedSample


class Compensation:
    """
    Evaluates known effects sample by sample.

    With an effect that replaces K_e, K_hat stays at the first guess; with one that replaces B_e,
    B_hat is 0. Effects of the robot have no influence.

    Parameters
    ----------
    effects : sequence of Effect
        Known effects.
    initial_stiffness : float
        First guess of K_e [N/m].
    force_noise : float
        Standard deviation of the force noise [N].

    """

    def __init__(
        self, effects: Sequence[Effect], initial_stiffness: float, force_noise: float
    ) -> None:
        # The law is linear in K_e: its column is the law with K_e = 1 less the law with K_e = 0.
        self._law, self._unit = (
            ContactLaw(K, 0.0, 0.0, 0.0, True, effects) for K in (0.0, 1.0)
        )
        wall, self._sensor = self._law.effects, _sensors(effects)
        self._placeholder = (
            initial_stiffness if any(e.replaces_stiffness for e in wall) else 0.0
        )
        self._tool = sum(effect.added_mass for effect in self._sensor)
        self._moves = self._law.inertia > 0.0 or self._tool > 0.0
        self._range = min((e.limit for e in self._sensor), default=math.inf)
        self._range -= _CLIPPED * force_noise
        lagging = [effect for effect in self._sensor if effect.memory]
        self._memories = [_memory(lagging) for _ in range(7)] if lagging else []
        self._states: State = (0.0,) * self._law.states
        self._first_ns: int | None = None
        self._t = self._depth = 0.0
        self._past: deque[_Past] = deque(maxlen=3)

    @property
    def acts(self) -> bool:
        """Whether there is anything to compensate."""
        return bool(self._law.effects or self._sensor)

    def take(
        self, stamp_ns: int, depth: float, velocity: float, force: float, pressing: float
    ) -> CompensatedSample:
        """
        Process one sample.

        Parameters
        ----------
        stamp_ns : int
            Stamp, later than the previous one [ns].
        depth : float
            x less the nominal x_e [m].
        velocity : float
            Measured rate of x [m/s], NaN where not measured.
        force, pressing : float
            Measured F_e; -F_e less the tare [N].

        Returns
        -------
        known : CompensatedSample
            Quantities of the relation.

        """
        if self._first_ns is None:
            self._first_ns, self._depth = stamp_ns, depth
        t = (stamp_ns - self._first_ns) * 1e-9
        dt = t - self._t
        v = velocity
        if v != v:  # a smoothed rate would be delayed, and with it the reversal of friction
            v = (depth - self._depth) / dt if dt > 0.0 else 0.0
        self._follow(t, depth, v)
        known = self._at_wall(t, depth, velocity, v)
        self._t, self._depth = t, depth
        c = 1.0 if known.depth > 0.0 and known.usable else 0.0
        wall, tool = self._inertial_forces(dt, depth, velocity, c) if self._moves else (0.0, 0.0)
        if self._memories:
            known, wall, tool = self._late(t, dt, c, known, wall, tool)
        for effect in reversed(self._sensor):
            pressing = -effect.undo(t, -pressing)
        known = known._replace(
            pressing=pressing - tool, rest=pressing - known.rest,
            usable=known.usable and abs(force) < self._range,
        )
        return self._averaged(known, wall + tool) if self._moves else known

    def _follow(self, t: float, depth: float, velocity: float) -> None:
        """Integrate the internal states along a straight line from the last sample."""
        law = self._law
        if not law.states:
            return
        dt = t - self._t
        if dt <= 0.0:
            self._states = law.settle(t, depth, velocity, self._states)
            return
        h, x = dt / _STEPS, self._depth
        v = (depth - x) / dt
        for k in range(_STEPS):
            now = self._t + k * h
            rates = law.rates(now, x, v, self._states)
            middle = tuple([s + 0.5 * h * r for s, r in zip(self._states, rates)])
            rates = law.rates(now + 0.5 * h, x + 0.5 * h * v, v, middle)
            x += h * v
            moved = tuple([s + h * r for s, r in zip(self._states, rates)])
            self._states = law.settle(now + h, x, v, moved)

    def _at_wall(self, t: float, x: float, velocity: float, v: float) -> CompensatedSample:
        """Evaluate the wall without sensor and inertia; `rest` is R here."""
        law, states = self._law, self._states
        d, rate, engaged = law.penetration(t, x, v, states, math)
        R = law.resistance(t, x, v, states, math)
        column, slope = d, 1.0
        if self._placeholder:
            R -= self._placeholder * d
        elif law.bends_stiffness:
            column = self._column(t, x, v)
            slope = (self._column(t, x + _NEAR, v) - self._column(t, x - _NEAR, v)) / (2.0 * _NEAR)
        measured = rate if velocity == velocity else nan
        travel = law.travel(t, x, states, math)
        return CompensatedSample(d, 0.0, R, travel, measured, column, slope, bool(engaged))

    def _column(self, t: float, x: float, v: float) -> float:
        unit, law, states = self._unit, self._law, self._states
        return float(unit.resistance(t, x, v, states, math)
                     - law.resistance(t, x, v, states, math))

    def _late(
        self, t: float, dt: float, c: float, known: CompensatedSample, wall: float, tool: float
    ) -> tuple[CompensatedSample, float, float]:
        """Pass all columns through the lag and delay of the sensor."""
        depth, _, R, travel, v, column, slope, _ = known
        columns = (c * R, c * travel, c * v if v == v else 0.0, c * column, c * slope, wall, tool)
        R, travel, rate, column, slope, wall, tool = (
            memory(t, dt, value) for memory, value in zip(self._memories, columns)
        )
        v = rate if v == v else v
        return CompensatedSample(depth, 0.0, R, travel, v, column, slope, True), wall, tool

    def _inertial_forces(
        self, dt: float, depth: float, velocity: float, contact: float
    ) -> tuple[float, float]:
        """Return M_e a and mass a of the previous sample, from central differences."""
        past = self._past
        past.append(_Past(depth, velocity, contact, _NOTHING))
        if len(past) < 3 or dt <= 0.0:
            return 0.0, 0.0
        first, middle, last = past
        rise = last.velocity - first.velocity
        if rise == rise:
            a = rise / (2.0 * dt)
        else:
            a = (last.depth - 2.0 * middle.depth + first.depth) / dt**2
        return middle.contact * self._law.inertia * a, self._tool * a

    def _averaged(self, known: CompensatedSample, inertial_force: float) -> CompensatedSample:
        """
        Average the last three samples with the weights of eq. (31).

        The average matches a central difference over the same samples, which is neither delayed
        against it nor as noisy as an acceleration at the newest sample.

        """
        past = self._past
        past[-1] = past[-1]._replace(known=known)
        first, middle, last = (past[k].known for k in (0, len(past) // 2, -1))
        rest, travel, v, column, slope = (
            0.25 * (a + b + b + c) for a, b, c in zip(first[2:7], middle[2:7], last[2:7])
        )
        usable = first.usable and middle.usable and last.usable and len(past) == 3
        return CompensatedSample(
            known.depth, known.pressing, rest - inertial_force, travel, v, column, slope, usable
        )


_NOTHING = CompensatedSample(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False)


def _sensors(effects: Sequence[Effect]) -> list[Any]:
    return [effect for effect in effects if isinstance(effect, ForceSensorEffect)]


def _memory(effects: Sequence[Any]) -> Memory:
    """Return the dynamic part of a sensor as a filter for one signal."""
    own = [type(effect)(effect.values) for effect in effects]

    def sense(t: float, dt: float, value: float) -> float:
        for effect in own:
            value = effect.sense(t, dt, value, 0.0)
        return value

    return sense
