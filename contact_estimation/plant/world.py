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

import math
from math import ceil
from typing import Any, Callable, NamedTuple

from .plant_parameters import PlantParameters
from ..physics import effects_that_are_on
from ..physics.contact_law import ContactLaw
from ..physics.physics import ForceSensorEffect
from ..physics.robot_law import RobotLaw

State = tuple[float, ...]  # x, v, then the effects' internal states
ReferenceAt = Callable[[float], tuple[float, float, float, float]]
_BISECTIONS = 40


class Mode(NamedTuple):
    """
    Which equation of contact holds; each is smooth by itself.

    Attributes
    ----------
    contact : bool
        The surface is reached and a force can be passed on.
    pressing : bool
        And the wall pushes; otherwise it has let go, or pulls as hard as it can.
    held : bool
        Out of contact, but the wall still pulls.

    """

    contact: bool
    pressing: bool
    held: bool


class Truth(NamedTuple):
    """
    The world at an instant, before any noise.

    Attributes
    ----------
    t : float
        Time [s].
    position, velocity, acceleration : float
        Of the end-effector [m], [m/s], [m/s^2].
    force : float
        F_e [N], negative while pressing.
    sensed : float
        What the physics of the force sensor make of F_e [N].

    """

    t: float
    position: float
    velocity: float
    acceleration: float
    force: float
    sensed: float


class World:
    """
    Impedance-controlled robot against a wall.

    M_t xdd = u - drag + F_e with u of eq. (1) and F_e of eq. (3), plus what the effects add.
    Fourth-order Runge-Kutta; touch-down and release are found by bisection and stepped onto, so
    that no step straddles a switch of equations. The physics of the force sensor follow at every
    step, for a lag is no matter of samples.

    Parameters
    ----------
    parameters : PlantParameters
        The world.
    position : float
        Where the robot rests at t = 0 [m].

    """

    def __init__(self, parameters: PlantParameters, position: float) -> None:
        self.t = 0.0
        self._physics: Any = None
        self.configure(parameters)
        self._state: State = (position, 0.0) + (0.0,) * self._law.states
        self._last_sensed = (-1.0, 0.0)

    def configure(self, parameters: PlantParameters) -> None:
        """
        Change the world while it runs.

        Parameters
        ----------
        parameters : PlantParameters
            The new world; the set of effects with internal states must stay.

        """
        if parameters.physics != self._physics:  # else effects would forget their past
            self._physics = parameters.physics
            self._effects = effects_that_are_on(parameters.physics)
            self._chain = [e for e in self._effects if isinstance(e, ForceSensorEffect)]
        effects = self._effects
        wall, robot = parameters.environment, parameters.robot
        self._law = ContactLaw(
            wall.stiffness, wall.damping, wall.location, wall.inertia, wall.unilateral, effects
        )
        self._robot = RobotLaw(robot.mass, robot.damping, robot.stiffness, effects)
        self._force_tracking = robot.force_tracking
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
            if self._chain:
                self.truth(reference)
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
        x, v, *_ = self._state
        acceleration, force, _ = self._dynamics(self.t, self._state)
        return Truth(self.t, x, v, acceleration, force, self._sense(force, acceleration))

    def _sense(self, force: float, acceleration: float) -> float:
        last, reading = self._last_sensed
        if last == self.t:  # a lag must not pass the same instant twice
            return reading
        dt = self.t - last if last >= 0.0 else 0.0
        for effect in self._chain:
            force = effect.sense(self.t, dt, force, acceleration)
        self._last_sensed = (self.t, force)
        return force

    # -- equations --------------------------------------------------------------------------

    def _control(self, t: float, x: float, v: float) -> float:
        """Eq. (1) without F_e: the force that drives the robot's mass."""
        x_r, v_r, a_r, F_r = self._reference(t - self._robot.reference_delay)
        tracked = F_r if self._force_tracking and F_r == F_r else 0.0
        return float(self._robot.force(x, v, (x_r, v_r, a_r, tracked), math))

    def _dynamics(
        self, t: float, state: State, mode: Mode | None = None
    ) -> tuple[float, float, Mode]:
        """Solve for acceleration and F_e, under the equations of a mode if one is given."""
        law = self._law
        x, v = state[0], state[1]
        u, mass = self._control(t, x, v), self._robot.mass
        contact, resistance, free = law.touch(t, x, v, state[2:], math)
        if mode is None:
            pressing = -resistance
            if law.inertia > 0.0 and contact:
                pressing -= law.inertia * (u - resistance) / (mass + law.inertia)
            pushes = contact and (pressing < law.pull or not law.unilateral)
            mode = Mode(bool(contact), bool(pushes), not contact and free != 0.0)
        if mode.pressing:
            a = (u - resistance) / (mass + law.inertia)
            return a, -(resistance + law.inertia * a), mode
        force = law.pull if mode.contact else (free if mode.held else 0.0)
        return (u + force) / mass, force, mode

    def _rates(self, t: float, state: State, mode: Mode) -> State:
        rates: State = (state[1], self._dynamics(t, state, mode)[0])
        if len(state) > 2:
            law = self._law
            d, v, _ = law.penetration(t, state[0], state[1], state[2:], math)
            rates += law.rates(t, d, v, state[2:])
        return rates

    # -- integration ------------------------------------------------------------------------

    def _runge_kutta(self, t: float, state: State, h: float, mode: Mode) -> State:
        half = 0.5 * h
        k1 = self._rates(t, state, mode)
        k2 = self._rates(t + half, tuple(s + half * k for s, k in zip(state, k1)), mode)
        k3 = self._rates(t + half, tuple(s + half * k for s, k in zip(state, k2)), mode)
        k4 = self._rates(t + h, tuple(s + h * k for s, k in zip(state, k3)), mode)
        after = tuple(
            s + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
            for s, a, b, c, d in zip(state, k1, k2, k3, k4)
        )
        return self._settle(t + h, after) if len(after) > 2 else after

    def _settle(self, t: float, state: State) -> State:
        law = self._law
        d, v, _ = law.penetration(t, state[0], state[1], state[2:], math)
        return state[:2] + tuple(law.settle(d, v, state[2:]))

    def _mode(self, t: float, state: State) -> Mode:
        return self._dynamics(t, state)[2]

    def _step_with_events(self, t: float, h: float) -> None:
        """Step, cut at every switch of the contact equation."""
        end = t + h
        for _ in range(8):  # more switches within one step would be chatter at the surface
            mode = self._mode(t, self._state)
            after = self._runge_kutta(t, self._state, end - t, mode)
            if self._mode(end, after) == mode:
                break
            low, high = 0.0, end - t
            for _ in range(_BISECTIONS):
                middle = 0.5 * (low + high)
                state = self._runge_kutta(t, self._state, middle, mode)
                if self._mode(t + middle, state) == mode:
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
