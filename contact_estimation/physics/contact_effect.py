# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base class of the effects of the wall."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from .effect import Effect
from .numeric import Array, Flags, Number

HOOKS = (
    'surface', 'transmit', 'deflection', 'spring', 'damper', 'carried', 'resistance', 'tail')
"""Methods by which a law changes the force, in the order of evaluation."""


class ContactEffect(Effect):
    """
    Physics of the wall: F_e = -(spring + damper + sum of resistances + inertia a) in contact.

    Every hook returns its input unchanged by default; a subclass overrides those that its law
    changes. They are evaluated in the order surface, transmit, deflection, spring, damper,
    carried, resistance; `pull` and `tail` then describe positive forces.

    """

    port = 'contact'
    states: ClassVar[int] = 0
    """Number of internal states, integrated with the plant."""

    weights: ClassVar[tuple[str, ...]] = ()
    """Parameters that weigh the states, and on which they do not depend."""

    replaces_stiffness: ClassVar[bool] = False
    """Whether K_e is undefined with this effect."""

    replaces_damping: ClassVar[bool] = False
    """Whether B_e is undefined with this effect."""

    jumps: ClassVar[bool] = False
    """Whether the resistance depends on the rate alone and jumps where the motion reverses."""

    inertia: float = 0.0
    """Mass that moves with the contact point [kg]."""

    exponent: float = 1.0
    """Power of the depth in the elastic force."""

    pull: float = 0.0
    """Largest positive F_e in contact [N]."""

    def surface(self, t: Number, state: Any, m: Any) -> tuple[Any, Any]:
        """
        Return the displacement of the surface.

        Parameters
        ----------
        t : float or ndarray, shape (N,)
            Time since the first sample [s].
        state : sequence
            Internal states of the effect.
        m : module
            `math` or `numpy`.

        Returns
        -------
        shift, rate : float or ndarray, shape (N,)
            Displacement of x_e [m] and its rate [m/s].

        """
        return 0.0, 0.0

    def transmit(self, d: Number, v: Number, state: Any, m: Any) -> tuple[Any, Any, Any]:
        """
        Return the part of the tool's motion that reaches the wall; parameters as `resistance`.

        Returns
        -------
        d, v : float or ndarray, shape (N,)
            Penetration [m] and rate [m/s] at the wall.
        engaged : bool or ndarray of bool
            Whether a force can be transmitted.

        """
        return d, v, True

    def deflection(self, d: Number, m: Any) -> Number:
        """
        Return the compression of the linear spring.

        Parameters
        ----------
        d : float or ndarray, shape (N,)
            Penetration [m].
        m : module
            `math` or `numpy`.

        Returns
        -------
        deflection : float or ndarray, shape (N,)
            Compression [m].

        """
        return d

    def spring(self, t: Number, d: Number, force: Number, m: Any) -> Number:
        """
        Return the elastic force.

        Parameters
        ----------
        t, d : float or ndarray, shape (N,)
            Time [s] and penetration [m].
        force : float or ndarray, shape (N,)
            Elastic force before this effect, K_e times the deflection [N].
        m : module
            `math` or `numpy`.

        Returns
        -------
        force : float or ndarray, shape (N,)
            Elastic force [N].

        """
        return force

    def damper(self, d: Number, v: Number, force: Number, exponent: float, m: Any) -> Number:
        """
        Return the damping force.

        Parameters
        ----------
        d, v : float or ndarray, shape (N,)
            Penetration [m] and its rate [m/s].
        force : float or ndarray, shape (N,)
            Damping force before this effect, B_e v [N].
        exponent : float
            Power of the depth in the elastic force.
        m : module
            `math` or `numpy`.

        Returns
        -------
        force : float or ndarray, shape (N,)
            Damping force [N].

        """
        return force

    def carried(self, d: Number, spring: Number, damper: Number, m: Any) -> Number:
        """
        Return what of spring and damper together reaches the tool.

        Parameters
        ----------
        d : float or ndarray, shape (N,)
            Penetration [m].
        spring, damper : float or ndarray, shape (N,)
            Elastic and damping force [N].
        m : module
            `math` or `numpy`.

        Returns
        -------
        force : float or ndarray, shape (N,)
            In all [N].

        """
        return spring + damper

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """
        Return the additional force R that resists penetration.

        Parameters
        ----------
        t, d, v : float or ndarray, shape (N,)
            Time [s], penetration [m] and its rate [m/s].
        state : sequence
            Internal states of the effect.
        m : module
            `math` or `numpy`.

        Returns
        -------
        R : float or ndarray, shape (N,)
            Force [N], positive where it resists.

        """
        return 0.0 * v

    def tail(self, d: Number, v: Number, state: Any, m: Any) -> Number:
        """
        Return F_e out of contact (d <= 0); parameters as `resistance`.

        Returns
        -------
        F_e : float or ndarray, shape (N,)
            Force [N].

        """
        return 0.0 * v

    def state_rates(
        self, t: float, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """
        Return the rates of the internal states; parameters as `resistance`, contact is d > 0.

        Returns
        -------
        rates : tuple of float, length `states`
            Time derivatives.

        """
        return (0.0,) * self.states

    def settle(
        self, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """
        Project the internal states onto their valid range after an integration step.

        Parameters
        ----------
        d, v, contact, state
            As for `state_rates`.

        Returns
        -------
        state : tuple of float, length `states`
            Projected states.

        """
        return state

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        """
        Integrate the internal states along a recorded motion, from 0 (midpoint rule).

        Parameters
        ----------
        t, d, v : ndarray, shape (N,)
            Time [s], evenly spaced, penetration [m] and its rate [m/s], both before this effect
            changes them.
        contact : ndarray of bool, shape (N,)
            d > 0.

        Returns
        -------
        states : ndarray, shape (states, N)
            States at the samples; or what else the effect makes its force of, if m is numpy.

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


@lru_cache(maxsize=None)
def overridden(cls: type[ContactEffect]) -> frozenset[str]:
    """Return which of `HOOKS` the law of a class changes; cached, since every fit step asks."""
    return frozenset(hook for hook in HOOKS
                     if getattr(cls, hook) is not getattr(ContactEffect, hook))
