# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The known physics of a wall whose surface may not be known yet.

Until it is, nothing of the wall acts and its states rest. The motion of the meantime is kept, and
followed from the last sample outside on as soon as the surface is known, so that a contact in
progress has the states that it would have had.
"""

from collections import deque
import math
from math import nan
from typing import Callable, NamedTuple, Sequence

from .contact_effect import State
from .contact_law import ContactLaw
from .effect import Effect

_STEPS = 4  # integration steps of internal states per sample
_MOST_STEPS = 400  # over a gap: bounds the time that one sample may take
_NEAR = 1e-7  # step of the difference quotient of phi_K [m]
_FAR = 1.0  # out of reach of any wall [m]
_APPROACH = 50  # samples outside the wall, in which a play is taken up
_KEPT = 1000  # samples of motion while the surface is not known
Memory = Callable[[float, float, float], float]  # time, time step, value -> value

WAITING = 'waiting for consecutive samples'
NOT_LOCATED = 'waiting for the surface, beyond which known physics of the wall act'
NOT_FINITE = 'known physics give no finite force here; check the parameters of physics'
IN_PLAY = 'the tool moves within its play'


class Motion(NamedTuple):
    """Motion at a sample."""

    # t, dt: time, and that since the sample before [s]; 0 at the first
    t: float
    dt: float
    # x, velocity, rate: position [m], its measured rate (NaN where there is none), and one that is
    # never NaN [m/s]
    x: float
    velocity: float
    rate: float
    acceleration: float  # of the sample before [m/s^2]; 0 where it is not known
    periods: float  # sample periods since the sample before


class WallTerms(NamedTuple):
    """What a wall adds to the relation of a sample."""

    # depth, force, inertial_force: penetration [m], and known force without inertia, and of the
    # inertia, [N]
    depth: float
    force: float
    inertial_force: float
    # travel, velocity, stiffness_column, constant_column: as of `CompensatedSample`
    travel: float
    velocity: float
    stiffness_column: float
    constant_column: float
    hindrance: str  # why the relation does not hold; '' where it does


class KnownWall:
    """
    Evaluates known physics of a wall sample by sample, as the force sensor passes them on.

    effects: those of other ports have no influence
    initial_stiffness: first guess of K_e [N/m], kept where an effect replaces K_e
    memory: makes a filter like the force sensor's for one signal; None: the sensor has no memory
    acts: whether there are known physics of the wall
    inertia: M_e [kg]
    free_force: F_e far from the wall, as of a weight [N]
    """

    def __init__(
        self, effects: Sequence[Effect], initial_stiffness: float,
        memory: Callable[[], Memory] | None,
    ) -> None:
        # The law is linear in K_e: its column is the law with K_e = 1 less the law with K_e = 0.
        self._law, self._unit = (
            ContactLaw(K, 0.0, 0.0, 0.0, True, effects, initial_stiffness) for K in (0.0, 1.0))
        self.acts, self.inertia = bool(self._law.effects), self._law.inertia
        self.free_force = float(self._law.tail(-_FAR, 0.0, (0.0,) * self._law.states, math))
        self._placeholder = initial_stiffness if self._law.replaces_stiffness else 0.0
        self._memory = memory
        self._kept: deque[Motion] = deque(maxlen=_KEPT if self.acts or memory else 3)
        self._rest()

    def _rest(self) -> None:
        """Return to a wall that was never touched."""
        self._states: State = (0.0,) * self._law.states
        self._last: Motion | None = None
        self._touched = 0.0  # 1 where the last sample was in contact
        self._memories = [self._memory() for _ in range(6)] if self._memory else []
        self._terms: deque[WallTerms] = deque(maxlen=3)

    def take(self, now: Motion, location: float) -> Sequence[WallTerms]:
        """Process one sample; location is x_e nominal [m], NaN if unknown."""
        if location != location:
            if self._last is not None:
                self._rest()
            self._kept.append(now)
            return (_NOT_LOCATED,)
        if self._kept:
            for earlier in self._since_outside(location):
                self._append(self._next(earlier, location))
            self._kept.clear()
        self._append(self._next(now, location))
        return self._terms

    def _append(self, terms: WallTerms) -> None:
        self._terms.append(terms)  # to those after a rest, if `_next` was one

    def _since_outside(self, location: float) -> list[Motion]:
        """Return the motion kept, from the approach to the wall on."""
        kept, rest = list(self._kept), (0.0,) * self._law.states
        for k in range(len(kept) - 1, -1, -1):
            t, _, x, _, v, *_ = kept[k]
            if self._law.penetration(t, x - location, v, rest, math)[0] <= 0.0:
                return kept[max(k - _APPROACH, 0):]
        return kept

    def nominal(self, surface: float) -> float:
        """Return x_e nominal [m] of a wall first met at `surface`, where effects displace it."""
        touched = [k for k, moved in enumerate(self._kept) if moved.x <= surface]
        if not touched:
            return surface
        kept = list(self._kept)[max(touched[-1] - _APPROACH, 0):touched[-1] + 1]
        for moved in kept:
            self._follow(moved, surface)
            self._last = moved
        d, *_ = self._law.penetration(kept[-1].t, 0.0, 0.0, self._states, math)
        self._rest()
        return surface + d if d - d == 0.0 else surface

    def _next(self, now: Motion, location: float) -> WallTerms:
        """Evaluate one sample; nothing that is not finite is kept."""
        depth = now.x - location
        try:
            self._follow(now, location)
            terms = self._at_surface(now, depth)
            total = (terms.depth + terms.force + terms.travel + terms.stiffness_column
                     + terms.constant_column + sum(self._states))
        except ArithmeticError:
            total = nan
        if total - total != 0.0:  # inf - inf is NaN
            self._rest()
            terms = _NOT_LOCATED._replace(depth=depth, hindrance=NOT_FINITE)
        inertial = self._touched * self.inertia * now.acceleration
        self._touched = 1.0 if terms.depth > 0.0 and not terms.hindrance else 0.0
        self._last = now
        if self._memories:
            return self._late(now, terms, inertial)
        return terms._replace(inertial_force=inertial) if self.inertia else terms

    def _follow(self, now: Motion, location: float) -> None:
        """Integrate the internal states along a straight line from the last sample."""
        law, last = self._law, self._last
        if not law.states:
            return
        t, dt, x, _, v, _, periods = now
        if last is None or dt <= 0.0:
            self._states = law.settle(t, x - location, v, self._states)
            return
        steps = _STEPS
        if periods > 1.5:
            steps = int(min(math.ceil(periods) * _STEPS, _MOST_STEPS))
        h, x, t = dt / steps, last.x - location, last.t
        v = (now.x - last.x) / dt
        for k in range(steps):
            rates = law.rates(t + k * h, x, v, self._states)
            middle = tuple([s + 0.5 * h * r for s, r in zip(self._states, rates)])
            rates = law.rates(t + (k + 0.5) * h, x + 0.5 * h * v, v, middle)
            x += h * v
            moved = tuple([s + h * r for s, r in zip(self._states, rates)])
            self._states = law.settle(t + (k + 1) * h, x, v, moved)

    def _at_surface(self, now: Motion, x: float) -> WallTerms:
        """Evaluate the wall without sensor and inertia."""
        law, states, t, v = self._law, self._states, now.t, now.rate
        d, rate, engaged = law.penetration(t, x, v, states, math)
        R = law.resistance(t, x, v, states, math)
        column, slope = d, 1.0
        if self._placeholder:
            R -= self._placeholder * d
        elif law.bends_stiffness:
            column = self._column(t, x, v)
            slope = (self._column(t, x + _NEAR, v) - self._column(t, x - _NEAR, v)) / (2.0 * _NEAR)
        measured = rate if now.velocity == now.velocity else nan
        travel = law.travel(t, x, states, math)
        return WallTerms(d, R, 0.0, travel, measured, column, slope, '' if engaged else IN_PLAY)

    def _column(self, t: float, x: float, v: float) -> float:
        unit, law, states = self._unit, self._law, self._states
        return float(unit.resistance(t, x, v, states, math)
                     - law.resistance(t, x, v, states, math))

    def _late(self, now: Motion, terms: WallTerms, inertial: float) -> WallTerms:
        """Pass all terms through the lag and delay of the sensor."""
        depth, R, _, travel, v, column, slope, hindrance = terms
        c = self._touched
        values = (c * R, inertial, c * travel, c * v if v == v else 0.0, c * column, c * slope)
        R, inertial, travel, rate, column, slope = (
            memory(now.t, now.dt, value) for memory, value in zip(self._memories, values))
        return WallTerms(depth, R, inertial, travel, rate if v == v else v, column, slope,
                         '' if hindrance is IN_PLAY else hindrance)


_NOT_LOCATED = WallTerms(nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, NOT_LOCATED)
