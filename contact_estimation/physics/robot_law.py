# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The impedance law of a robot with all its effects, for numbers and arrays."""

import math
from typing import Any, Sequence

import numpy as np

from .contact_effect import State
from .effect import Effect
from .force_lag import ForceLag
from .numeric import Array
from .robot_effect import RobotEffect


class RobotLaw:
    """
    Eq. (1) as a force on a mass: mass xdd = force + F_e.

    force = f - drag(xd), tau f' + f = control(M_t xdd_r - B_t (xd - xd_r) - K_t (x - x_r) + F_r),
    the reference delayed by `reference_delay`, F_r with force tracking only. With a joint the
    force drives the motor, and the joint drives the link.

    mass: moving mass [kg], motor and link
    damping, stiffness: of the impedance law [N s/m], [N/m]
    states: number of internal states: position [m] and velocity [m/s] of the motor with a joint,
    then f [N] with a lag of the drives
    """

    def __init__(
        self, mass: float, damping: float, stiffness: float, effects: Sequence[Effect]
    ) -> None:
        arm = [effect for effect in effects if isinstance(effect, RobotEffect)]
        for effect in arm:
            mass, damping, stiffness = effect.impedance(mass, damping, stiffness)
        self._feed_forward, self.damping, self.stiffness = mass, damping, stiffness
        self.mass = self._feed_forward + sum(effect.reflected_inertia for effect in arm)
        self.reference_delay = sum(effect.reference_delay for effect in arm)
        self._lag = sum(effect.lag for effect in arm)
        joints = [effect.joint(self._feed_forward) for effect in arm]
        self.joint = next((joint for joint in joints if joint is not None), None)
        self.states = 2 * (self.joint is not None) + (self._lag > 0.0)
        self._controls = [effect for effect in arm if 'control' in effect.changes]
        self._drags = [effect for effect in arm if 'drag' in effect.changes]

    def impedance_force(self, x: Any, v: Any, reference: Any) -> Any:
        """Return u (N,) [N] at x, v (N,) for a reference (4, N): x_r, its rates, F_r (0: none)."""
        x_r, v_r, a_r, F_r = reference
        return (self._feed_forward * a_r - self.damping * (v - v_r)
                - self.stiffness * (x - x_r) + F_r)

    def force(self, x: Any, v: Any, reference: Any, m: Any) -> Any:
        """Return the force that drives the mass [N], without F_e and lag."""
        return self.less_drag(self.control(x, v, reference, m), v, m)

    def control(self, x: Any, v: Any, reference: Any, m: Any) -> Any:
        """Return the force that is asked of the drives [N]; parameters as `force`."""
        u = self.impedance_force(x, v, reference)
        for effect in self._controls:
            u = effect.control(u, m)
        return u

    def less_drag(self, f: Any, v: Any, m: Any) -> Any:
        """Subtract the drag at a velocity v [m/s] from the force f of the drives [N]."""
        for effect in self._drags:
            f = f - effect.drag(v, m)
        return f

    @property
    def link_mass(self) -> float:
        """Mass that touches the wall [kg]."""
        return self.mass if self.joint is None else self.joint.mass

    def at_rest(self, x: float, v: float) -> State:
        """Return the states of a link that moves with its motor; a lag's is not yet known."""
        moving = () if self.joint is None else (x, v)
        return (*moving, *(math.nan,) * (self._lag > 0.0))

    def started(self, x: float, v: float, states: State, reference: Any) -> State:
        """Return the states once the reference is known; parameters as `drive` and `rates`."""
        if not self._lag or states[-1] == states[-1]:
            return states
        return (*states[:-1], self.control(*self.motor(x, v, states), reference, math))

    def motor(self, x: float, v: float, states: State) -> tuple[float, float]:
        """Return position [m] and velocity [m/s] as measured; parameters as `drive`."""
        return (x, v) if self.joint is None else (states[0], states[1])

    def drive(self, x: float, v: float, states: State) -> float:
        """Return the force that drives the link at x, v [N], without F_e."""
        if self.joint is None:
            return float(self.less_drag(states[-1], v, math))
        return float(self.joint.force(states[0] - x, states[1] - v))

    def rates(self, x: float, v: float, states: State, reference: Any) -> State:
        """Return the rates of the internal states."""
        x_m, v_m = self.motor(x, v, states)
        u = self.control(x_m, v_m, reference, math)
        f, lag = (states[-1], ((u - states[-1]) / self._lag,)) if self._lag else (u, ())
        if self.joint is None:
            return lag
        push = self.less_drag(f, v_m, math) - self.joint.force(x_m - x, v_m - v)
        return (v_m, push / (self.mass - self.joint.mass), *lag)

    def force_along(
        self, t: Array, x: Array, v: Array, reference: Array, missing: Array, blur: float
    ) -> Array:
        """
        Return the driving force along a motion, evenly spaced (N,) [N].

        Dry friction at rest is a bound: it is what holds the robot (D. Karnopp, J. Dyn. Sys.,
        Meas., Control 107, 1985), and so is any drag between those at v - blur and v + blur.

        missing (N,): F_e - mass xdd, what balances the force without drag [N]
        blur: error of v, or the speed below which a smooth sign is not yet one [m/s]
        """
        u = self.control(x, v, reference, np)
        if self._lag:
            u = ForceLag(self._lag).sense_along(t, u, u)
        least, most = (self.less_drag(u, v + way * blur, np) for way in (1.0, -1.0))
        return np.asarray(np.clip(-missing, least, most))

    @property
    def drags(self) -> bool:
        """Whether an effect opposes the motion."""
        return bool(self._drags)

    @property
    def is_linear(self) -> bool:
        """Whether no effect limits, delays or opposes the control force."""
        return not self._controls and not self._drags and not self._lag
