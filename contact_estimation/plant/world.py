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

"""Robot and wall, integrated finely with exact unilateral contact."""

from __future__ import annotations

from enum import Enum
import math
from math import ceil
from typing import Callable, NamedTuple

from .plant_parameters import PlantParameters
from ..physics import effects_that_are_on
from ..physics.physics import ContactEffect, RobotEffect

State = tuple[float, ...]  # x, v, then the effects' internal states
ReferenceAt = Callable[[float], tuple[float, float, float, float]]
_BISECTIONS = 40


class Mode(Enum):
    """Which equation of contact holds; each is smooth by itself."""

    FREE = 'free'
    PRESSING = 'pressing'
    SLACK = 'slack'
    """Inside the surface at rest, but the wall has let go: it cannot pull."""


class Truth(NamedTuple):
    """
    The world at an instant, before any sensor.

    Attributes
    ----------
    t : float
        Time [s].
    position, velocity, acceleration : float
        Of the end-effector [m], [m/s], [m/s^2].
    force : float
        F_e [N], negative while pressing.

    """

    t: float
    position: float
    velocity: float
    acceleration: float
    force: float


class World:
    """
    Impedance-controlled robot against a wall.

    M_t xdd = u - drag + F_e with u of eq. (1) and F_e of eq. (3), plus what the effects add.
    Fourth-order Runge-Kutta; touch-down and release are found by bisection and stepped onto, so
    that no step straddles a switch of equations.

    Parameters
    ----------
    parameters : PlantParameters
        The world.
    position : float
        Where the robot rests at t = 0 [m].

    """

    def __init__(self, parameters: PlantParameters, position: float) -> None:
        self.configure(parameters)
        self.t = 0.0
        states = sum(effect.states for effect in self._wall)
        self._state: State = (position, 0.0) + (0.0,) * states

    def configure(self, parameters: PlantParameters) -> None:
        """
        Change the world while it runs.

        Parameters
        ----------
        parameters : PlantParameters
            The new world; the set of effects with internal states must stay.

        """
        self._p = parameters
        effects = effects_that_are_on(parameters.physics)
        self._wall = [e for e in effects if isinstance(e, ContactEffect)]
        self._arm = [e for e in effects if isinstance(e, RobotEffect)]
        self._wall_mass = parameters.environment.inertia + sum(e.inertia for e in self._wall)
        robot = parameters.robot
        self._M_t = robot.mass * math.prod(e.mass_scale for e in self._arm)
        self._B_t = robot.damping * math.prod(e.damping_scale for e in self._arm)
        self._K_t = robot.stiffness * math.prod(e.stiffness_scale for e in self._arm)
        self._robot_mass = self._M_t + sum(e.reflected_inertia for e in self._arm)
        self._delay = sum(e.reference_delay for e in self._arm)
        self._steps = max(1, ceil(parameters.integration_rate / parameters.sample_rate))

    def advance(self, duration: float, reference: ReferenceAt) -> None:
        """
        Integrate.

        Parameters
        ----------
        duration : float
            Time to go [s].
        reference : callable
            Time [s] to (x_r, its rate, its acceleration, F_r).

        """
        self._reference = reference
        end, h = self.t + duration, duration / self._steps
        for k in range(self._steps):
            self._step_with_events(self.t, h if k < self._steps - 1 else end - self.t)
        self.t = end

    def truth(self, reference: ReferenceAt) -> Truth:
        """
        Look at the world now.

        Parameters
        ----------
        reference : callable
            As for `advance`.

        Returns
        -------
        truth : Truth
            Free of noise.

        """
        self._reference = reference
        mode = self._mode(self.t, self._state)
        acceleration = self._acceleration(self.t, self._state, mode)
        force = 0.0
        if mode is Mode.PRESSING:
            force = -(self._static_resistance(self.t, self._state)
                      + self._wall_mass * acceleration)
        return Truth(self.t, self._state[0], self._state[1], acceleration, force)

    # -- equations --------------------------------------------------------------------------

    def _control(self, t: float, x: float, v: float) -> float:
        """Eq. (1) without F_e: the force that drives the robot's mass."""
        x_r, v_r, a_r, F_r = self._reference(t - self._delay)
        u = self._M_t * a_r - self._B_t * (v - v_r) - self._K_t * (x - x_r)
        if self._p.robot.force_tracking and F_r == F_r:
            u += F_r
        for effect in self._arm:
            u = effect.control(u)
        return u - sum(effect.drag(v) for effect in self._arm)

    def _penetration(self, t: float, state: State) -> tuple[float, float]:
        d, v = state[0] - self._p.environment.location, state[1]
        for effect in self._wall:
            shift, rate = effect.surface(t)
            d, v = d - shift, v - rate
        return d, v

    def _static_resistance(self, t: float, state: State) -> float:
        """Sum spring, damper and resistances: the pressing force less inertia."""
        d, v = self._penetration(t, state)
        environment = self._p.environment
        spring, damper, other = environment.stiffness * d, environment.damping * v, 0.0
        first = 2
        for effect in self._wall:
            last = first + effect.states
            spring = effect.spring(t, d, spring, math)
            damper = effect.damper(d, v, damper, math)
            other += effect.resistance(t, d, v, state[first:last], math)
            first = last
        return spring + damper + other

    def _mode(self, t: float, state: State) -> Mode:
        if not self._p.environment.unilateral:
            return Mode.PRESSING
        if self._penetration(t, state)[0] <= 0.0:
            return Mode.FREE
        resistance = self._static_resistance(t, state)
        if self._wall_mass > 0.0:
            resistance += self._wall_mass * self._acceleration(t, state, Mode.PRESSING)
        return Mode.PRESSING if resistance > 0.0 else Mode.SLACK

    def _acceleration(self, t: float, state: State, mode: Mode) -> float:
        u = self._control(t, state[0], state[1])
        if mode is not Mode.PRESSING:
            return u / self._robot_mass
        return (u - self._static_resistance(t, state)) / (self._robot_mass + self._wall_mass)

    def _rates(self, t: float, state: State, mode: Mode) -> State:
        rates: State = (state[1], self._acceleration(t, state, mode))
        if len(state) > 2:
            d, v = self._penetration(t, state)
            first = 2
            for effect in self._wall:
                last = first + effect.states
                rates += effect.state_rates(t, d, v, d > 0.0, state[first:last])
                first = last
        return rates

    # -- integration ------------------------------------------------------------------------

    def _runge_kutta(self, t: float, state: State, h: float, mode: Mode) -> State:
        half = 0.5 * h
        k1 = self._rates(t, state, mode)
        k2 = self._rates(t + half, tuple(s + half * k for s, k in zip(state, k1)), mode)
        k3 = self._rates(t + half, tuple(s + half * k for s, k in zip(state, k2)), mode)
        k4 = self._rates(t + h, tuple(s + h * k for s, k in zip(state, k3)), mode)
        return tuple(
            s + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
            for s, a, b, c, d in zip(state, k1, k2, k3, k4)
        )

    def _step_with_events(self, t: float, h: float) -> None:
        """Step, cut at every switch of the contact equation."""
        end = t + h
        for _ in range(8):  # more switches within one step would be chatter at the surface
            mode = self._mode(t, self._state)
            after = self._runge_kutta(t, self._state, end - t, mode)
            if self._mode(end, after) is mode:
                break
            low, high = 0.0, end - t
            for _ in range(_BISECTIONS):
                middle = 0.5 * (low + high)
                state = self._runge_kutta(t, self._state, middle, mode)
                if self._mode(t + middle, state) is mode:
                    low = middle
                else:
                    high = middle
            # Just beyond the switch, where the new equation holds.
            self._state = self._runge_kutta(t, self._state, high, mode)
            t += high
            if t >= end:
                self.t = end
                return
        else:
            after = self._runge_kutta(t, self._state, end - t, self._mode(t, self._state))
        self._state = after
        self.t = end
