# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base class of the effects of the wall."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from .effect import Effect, Seen
from .numeric import Array, Flags, Number

State = tuple[float, ...]

_LAST = 0.01  # of the depth


@dataclass(frozen=True)
class ContactEffect(Effect):
    """
    Physics of the wall: F_e = -(spring + damper + sum of resistances + inertia a) in contact.

    A subclass overrides the hooks that its law changes, mostly `resistance` alone; one with
    internal states also their evolution. All hooks are written for numbers and arrays:

    - t, d, v: float or ndarray, shape (N,); time since the first sample [s], penetration [m] and
      its rate [m/s].
    - state: internal states of the effect, a tuple of numbers or an ndarray, shape (states, N).
    - m: the module `math` or `numpy`.

    Attributes
    ----------
    states : int
        Number of internal states, integrated with the plant.
    weights : tuple of str
        Parameters on which the states do not depend.
    lets_go : bool
        Whether the force may vanish during contact.
    jumps : bool
        Whether the resistance depends on the rate alone and jumps where the motion reverses.
    relaxes : bool
        Whether it is a memory of the elastic force (Fung's quasi-linear viscoelasticity): its d
        and v are those at which a straight spring K_e would have that force.

    """

    port = 'contact'
    states: ClassVar[int] = 0
    weights: ClassVar[tuple[str, ...]] = ()
    lets_go: ClassVar[bool] = False
    jumps: ClassVar[bool] = False
    relaxes: ClassVar[bool] = False

    @property
    def inertia(self) -> float:
        """Mass that moves with the contact point [kg]."""
        return 0.0

    @property
    def exponent(self) -> float:
        """Power of the depth in the elastic force."""
        return 1.0

    @property
    def pull(self) -> float:
        """Largest positive F_e in contact [N]."""
        return 0.0

    def surface(self, t: Number, state: Any, m: Any) -> tuple[Any, Any]:
        """Return the displacement of the surface [m] and its rate [m/s]."""
        return 0.0, 0.0

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        """Return d and v that reach the wall, and whether a force can be transmitted."""
        return d, v, True

    def deflection(self, t: Number, d: Number, m: Any) -> Number:
        """Return the compression of the spring K_e [m], of that before this effect."""
        return d

    def spring(self, d: Number, m: Any) -> Number:
        """Return the elastic force in place of that of K_e [N]."""
        raise NotImplementedError

    def elastic(self, d: Number, m: Any) -> Number:
        """Return the elastic force beside that spring [N]."""
        raise NotImplementedError

    def may_show(self, seen: Seen) -> bool:
        """Need a wall that resists more, or no less, where it is deepest."""
        # Otherwise what presses gives way where the force falls, as the beam of a force microscope
        # does while a sample relaxes: its compliance, not a law of the wall.
        if 'elastic' not in self.changes:
            return True
        last = np.array([1.0 - _LAST, 1.0]) * seen.depth
        less, most = seen.stiffness * last + self.elastic(last, np)
        return bool(most >= less)

    def damper(self, d: Number, v: Number, exponent: float, m: Any) -> Number:
        """Return the damping force in place of B_e v [N]; exponent of the elastic force."""
        raise NotImplementedError

    def carried(self, d: Number, spring: Number, damper: Number, m: Any) -> Number:
        """Return what of the forces of spring and damper together reaches the tool [N]."""
        return spring + damper

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return the additional force R [N], positive where it resists penetration."""
        return 0.0 * v

    def tail(self, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return F_e out of contact (d <= 0) [N]."""
        return 0.0 * v

    def state_rates(self, t: float, d: float, v: float, contact: bool, state: State) -> State:
        """Return the time derivatives of the internal states; contact is d > 0."""
        return (0.0,) * self.states

    def settle(self, d: float, v: float, contact: bool, state: State) -> State:
        """Return the internal states after a step of integration, within their valid range."""
        return state

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """
        Integrate the internal states along a recorded motion from 0, by the midpoint rule.

        A closed form in its place makes fits faster.

        Parameters
        ----------
        t, d, v : ndarray, shape (N,)
            Evenly spaced; d and v before this effect changes them.
        contact : ndarray of bool, shape (N,)
            d > 0.

        Returns
        -------
        states : ndarray, shape (states, N)
            At the samples; or what else the hooks make their force of, if m is numpy.

        """
        state = self.settle(float(d[0]), float(v[0]), bool(contact[0]), (0.0,) * self.states)
        h, states = float(t[1] - t[0]), [state]
        samples = list(zip(t.tolist(), d.tolist(), v.tolist(), contact.tolist()))
        for (t_0, d_0, v_0, c_0), (_, d_1, v_1, c_1) in zip(samples[:-1], samples[1:]):
            touching = c_0 or c_1
            k = self.state_rates(t_0, d_0, v_0, touching, state)
            middle = tuple(s + 0.5 * h * rate for s, rate in zip(state, k))
            d_m, v_m = 0.5 * (d_0 + d_1), 0.5 * (v_0 + v_1)
            k = self.state_rates(t_0 + 0.5 * h, d_m, v_m, touching, middle)
            state = tuple(s + h * rate for s, rate in zip(state, k))
            state = self.settle(d_1, v_1, c_1, state)
            states.append(state)
        return np.array(states).T
