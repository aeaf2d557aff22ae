# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Simulation of robot and wall with unilateral contact resolved within integration steps."""

from enum import Enum
from functools import partial
import math
from math import ceil, nan
from typing import Any, NamedTuple, Sequence

from .plant_parameters import PlantParameters
from ..physics import effects_that_are_on
from ..physics.contact_law import ContactLaw
from ..physics.effect import Effect
from ..physics.force_sensor_effect import ForceSensorEffect
from ..physics.robot_law import RobotLaw
from ..reference.setpoints import ReferenceAt

State = tuple[float, ...]
"""x [m], v [m/s], then the internal states of the effects."""


def shift(state: State, h: float, rates: State) -> State:
    """Return state + h rates."""
    return tuple([s + h * rate for s, rate in zip(state, rates)])


def combine(state: State, h: float, k1: State, k2: State, k3: State, k4: State) -> list[float]:
    """Return the state after a step h [s] with rates k1 to k4."""
    sixth = h / 6.0
    return [s + sixth * (a + 2.0 * b + 2.0 * c + d)
            for s, a, b, c, d in zip(state, k1, k2, k3, k4)]


class Mode(Enum):
    """Which equation of contact holds; each equation is smooth."""

    FREE = 'free'
    PRESSING = 'pressing'
    SLACK = 'slack'
    """The surface is reached, but the force is 0 or at the largest pull."""

    HELD = 'held'
    """Out of contact, but the wall still pulls."""


FREE, PRESSING, SLACK, HELD = Mode  # attribute access of an enumeration is slow


class Instant(NamedTuple):
    """Acceleration [m/s^2] and F_e [N] under the equation that holds."""

    acceleration: float
    force: float
    mode: Mode


_BISECTIONS = 30
_MOST_SWITCHES = 4.0
_CREDIT_A_STEP = 0.1  # a backlash resting at its end would switch at every step


class Truth(NamedTuple):
    """Noise-free state of the world at one instant."""

    t: float  # time [s]
    # position, velocity, acceleration: motion of the end-effector [m], [m/s], [m/s^2]: behind a
    # flexible joint position and velocity are those of the motor, as measured, the acceleration
    # that of the link
    position: float
    velocity: float
    acceleration: float
    force: float  # F_e [N], negative while pressing
    sensed: float  # F_e after the effects of the force sensor [N]


class World:
    """
    Impedance-controlled robot against a wall.

    M_t xdd = u - drag + F_e with u of eq. (1) and F_e of eq. (3), plus effects.
    Fourth-order Runge-Kutta; touch-down and release are located by bisection, so that no step
    straddles a switch of equations. Effects of the force sensor are evaluated at every step,
    because a lag is continuous in time.

    position, velocity: initial state of the robot [m], [m/s]
    further: effects in addition to those of the parameters, such as ones outside EFFECTS
    begin: time of the initial state [s], >= 0
    """

    def __init__(
        self, parameters: PlantParameters, position: float, velocity: float = 0.0,
        further: Sequence[Effect] = (), begin: float = 0.0,
    ) -> None:
        self.t, self._further = begin, further
        self._physics: Any = None
        self._effects: list[Effect] = []
        self._reference: ReferenceAt | None = None
        self._present: Instant | None = None
        self._state: State = (position, velocity)
        self.configure(parameters)
        self._last_sensed = (-1.0, 0.0)
        self._credit = _MOST_SWITCHES

    def configure(self, parameters: PlantParameters) -> None:
        """Change the parameters while running."""
        before = [effect.name for effect in self._effects]
        if parameters.physics != self._physics:  # else effects would lose their past
            self._physics = parameters.physics
            self._effects = [*effects_that_are_on(
                parameters.physics, parameters.sign_velocity), *self._further]
            self._chain = [e.reader() for e in self._effects if isinstance(e, ForceSensorEffect)]
        effects = self._effects
        wall, robot = parameters.environment, parameters.robot.law()
        self._law = ContactLaw(
            wall.stiffness, wall.damping, wall.location, wall.inertia, wall.unilateral, effects)
        self._robot = RobotLaw(robot.mass, robot.damping, robot.stiffness, effects)
        self._force_tracking = robot.force_tracking
        law = self._robot
        self._drive = law.impedance_force if law.is_linear else partial(law.force, m=math)
        self._rate = parameters.integration_rate
        if [effect.name for effect in effects] != before:
            self._state = (*self._state[:2], *(0.0,) * self._law.states)
            self._state += law.at_rest(*self._state[:2])
            self._reference = None
        self._forget()

    @property
    def position(self) -> float:
        """Measured position of the end-effector [m]."""
        return self._measured()[0]

    def advance(self, duration: float, reference: ReferenceAt) -> None:
        """Integrate over a duration [s]; the reference is the same whenever asked for a time."""
        self._follow(reference)
        steps = max(1, ceil(duration * self._rate - 1e-6))
        end, h = self.t + duration, duration / steps
        now = self._present or self._look(self.t, self._state)
        for k in range(steps):
            if self._chain:
                self._sense(now.force, now.acceleration)
            now = self._step_with_events(h if k < steps - 1 else end - self.t, now)
        self.t, self._present = end, now

    def truth(self, reference: ReferenceAt) -> Truth:
        """Return the present state of the world."""
        self._follow(reference)
        x, v = self._measured()
        self._present = self._present or self._look(self.t, self._state)
        acceleration, force, _ = self._present
        return Truth(self.t, x, v, acceleration, force, self._sense(force, acceleration))

    def _sense(self, force: float, acceleration: float) -> float:
        last, reading = self._last_sensed
        if last == self.t:  # a lag must not be advanced twice to the same time
            return reading
        dt = self.t - last if last >= 0.0 else 0.0
        for read in self._chain:
            force = read(self.t, dt, force, acceleration)
        self._last_sensed = (self.t, force)
        return force

    def _follow(self, reference: ReferenceAt) -> None:
        if reference is not self._reference:
            self._reference = reference
            self._forget()
            if self._robot.states:
                (x, v, *_), first = self._state, 2 + self._law.states
                self._state = self._state[:first] + self._robot.started(
                    x, v, self._state[first:], self._asked_for(self.t))

    def _forget(self) -> None:
        """Drop what was computed under another reference or other parameters."""
        self._asked, self._answer = nan, (0.0, 0.0, 0.0, 0.0)
        self._present = None

    # -- equations --------------------------------------------------------------------------

    def _measured(self) -> tuple[float, float]:
        """Return position [m] and velocity [m/s] of the motor."""
        x, v, *_ = self._state
        return self._robot.motor(x, v, self._state[2 + self._law.states:])

    def _driving(self, t: float, x: float, v: float, states: State) -> float:
        """Eq. (1) without F_e: the force that drives the mass at the wall."""
        if self._robot.states:
            return self._robot.drive(x, v, states[self._law.states:])
        return float(self._drive(x, v, self._asked_for(t)))

    def _asked_for(self, t: float) -> tuple[float, float, float, float]:
        """Return the reference that reaches the robot at a time."""
        if t != self._asked:  # a step asks twice for its middle and twice for its end
            assert self._reference is not None
            x_r, v_r, a_r, F_r = self._reference(t - self._robot.reference_delay)
            tracked = F_r if self._force_tracking and F_r == F_r else 0.0
            self._asked, self._answer = t, (x_r, v_r, a_r, tracked)
        return self._answer

    def _look(self, t: float, state: State) -> Instant:
        """Determine which equation of contact holds, and solve it."""
        law, mass = self._law, self._robot.link_mass
        x, v = state[0], state[1]
        u = self._driving(t, x, v, state[2:])
        contact, resistance, free = law.touch(t, x, v, state[2:], math)
        if not contact:
            return Instant((u + free) / mass, free, HELD if free else FREE)
        a = (u - resistance) / (mass + law.inertia)
        force = -(resistance + law.inertia * a)
        if force < law.pull or not law.unilateral:
            return Instant(a, force, PRESSING)
        return Instant((u + law.pull) / mass, law.pull, SLACK)

    def _acceleration(self, t: float, x: float, v: float, states: State, mode: Mode) -> float:
        """Solve for the acceleration under the equation of a mode."""
        u, law, mass = self._driving(t, x, v, states), self._law, self._robot.link_mass
        if mode is FREE:
            return u / mass
        if mode is PRESSING:
            resistance: float = law.resistance(t, x, v, states, math)
            return (u - resistance) / (mass + law.inertia)
        pull: float = law.pull if mode is SLACK else law.touch(t, x, v, states, math).free_force
        return (u + pull) / mass

    # -- integration ------------------------------------------------------------------------

    def _runge_kutta(self, t: float, state: State, h: float, now: Instant) -> State:
        """Step under the equation of the mode at the step's beginning."""
        if len(state) > 2:
            return self._runge_kutta_with_states(t, state, h, now)
        (x, v), half, solve = state, 0.5 * h, self._acceleration
        a, _, mode = now
        v_2 = v + half * a
        a_2 = solve(t + half, x + half * v, v_2, (), mode)
        v_3 = v + half * a_2
        a_3 = solve(t + half, x + half * v_2, v_3, (), mode)
        v_4 = v + h * a_3
        a_4 = solve(t + h, x + h * v_3, v_4, (), mode)
        sixth = h / 6.0
        return (x + sixth * (v + 2.0 * v_2 + 2.0 * v_3 + v_4),
                v + sixth * (a + 2.0 * a_2 + 2.0 * a_3 + a_4))

    def _runge_kutta_with_states(self, t: float, state: State, h: float, now: Instant) -> State:
        half, mode = 0.5 * h, now.mode
        x, v, *_ = state
        k1: State = (v, now.acceleration, *self._state_rates(t, x, v, state[2:]))
        k2 = self._rates(t + half, shift(state, half, k1), mode)
        k3 = self._rates(t + half, shift(state, half, k2), mode)
        k4 = self._rates(t + h, shift(state, h, k3), mode)
        x, v, *states = combine(state, h, k1, k2, k3, k4)
        settled = self._law.settle(t + h, x, v, tuple(states))
        return (x, v, *settled, *states[len(settled):])

    def _rates(self, t: float, state: State, mode: Mode) -> State:
        x, v, *_ = state
        states = state[2:]
        return (v, self._acceleration(t, x, v, states, mode), *self._state_rates(t, x, v, states))

    def _state_rates(self, t: float, x: float, v: float, states: State) -> State:
        """Return the rates of the wall's states, then of the robot's."""
        rates, robot = self._law.rates(t, x, v, states), self._robot
        if not robot.states:
            return rates
        return rates + robot.rates(x, v, states[self._law.states:], self._asked_for(t))

    def _step_with_events(self, h: float, now: Instant) -> Instant:
        """Step, split at switches of the contact equation unless it chatters."""
        t, end = self.t, self.t + h
        self._credit = min(_MOST_SWITCHES, self._credit + _CREDIT_A_STEP)
        while True:
            after = self._runge_kutta(t, self._state, end - t, now)
            then = self._look(end, after)
            if then.mode is now.mode or self._credit < 1.0:
                break
            self._credit -= 1.0
            # Ends just after the switch, where the new equation holds.
            until = self._until_switch(t, end - t, now)
            self._state = self._runge_kutta(t, self._state, until, now)
            t += until
            now = self._look(t, self._state)
            if t >= end:
                self.t = end
                return now
        self._state, self.t = after, end
        return then

    def _until_switch(self, t: float, h: float, now: Instant) -> float:
        """Return the time until another equation holds [s], by bisection."""
        low, high = 0.0, h
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            state = self._runge_kutta(t, self._state, middle, now)
            if self._look(t + middle, state).mode is now.mode:
                low = middle
            else:
                high = middle
        return high
