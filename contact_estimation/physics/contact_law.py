# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The contact force of a wall with all its effects, for numbers and arrays."""

from functools import lru_cache
import math
from typing import Any, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .contact_effect import ContactEffect, State
from .effect import Effect
from .kept_motion import KeptMotion, StatesAlong, WallMotion
from .numeric import Array

_KEPT = KeptMotion()
_HOOKS = ('surface', 'transmit', 'deflection', 'spring', 'elastic', 'damper', 'carried',
          'resistance', 'tail')
_NEAR, _LEAST_NEAR = 1e-4, 1e-9  # steps of difference quotients, of the depth and in [m]


class Touch(NamedTuple):
    """Contact state and forces without inertia."""

    contact: Any  # whether the surface is reached and a force can be transmitted
    resistance: Any  # sum of spring, damper and resistances [N]
    free_force: Any  # F_e out of contact [N]


class ContactLaw:
    """
    Eq. (3) with a unilateral wall, extended by effects.

    F_e = min(pull, -(resistance + inertia a)) in contact, else the free force; pull is 0 without
    adhesion.

    stiffness, damping, location, inertia: K_e [N/m], B_e [N s/m], x_e [m], M_e [kg]
    usual: K_e by which relaxing effects weigh other elastic forces [N/m]; K_e itself by default
    """

    def __init__(
        self, stiffness: float, damping: float, location: float, inertia: float,
        unilateral: bool, effects: Sequence[Effect], usual: float | None = None,
    ) -> None:
        self.stiffness, self.damping, self._x_e = stiffness, damping, location
        self._usual = stiffness if usual is None else usual
        self.unilateral = unilateral
        wall = [effect for effect in effects if isinstance(effect, ContactEffect)]
        self.effects = wall
        self.inertia = inertia + sum(effect.inertia for effect in wall)
        self.pull = sum(effect.pull for effect in wall)
        self.states = sum(effect.states for effect in wall)
        self._exponent = math.prod(effect.exponent for effect in wall)
        placed, first = [], 0
        for effect in wall:
            placed.append((effect, slice(first, first + effect.states)))
            first += effect.states
        # Only overridden hooks are called: a plant evaluates the law 20 000 times per second.
        users, self._is_plain = _users_of_hooks(tuple(map(type, wall)))
        (self._surfaces, self._transmissions, self._deflections, self._springs, self._elastics,
         self._dampers, self._carriers, self._resistances, self._tails) = (
            [placed[k] for k in numbers] for numbers in users)
        bends = [*self._deflections, *self._springs, *self._elastics]
        self._bends = [place[0] for place in bends] if self._usual > 0.0 else []
        self._stateful = [place for place in placed if place[0].states]

    @property
    def replaces_stiffness(self) -> bool:
        """Whether an effect is in the place of K_e."""
        return bool(self._springs)

    @property
    def bends_stiffness(self) -> bool:
        """Whether K_e multiplies something other than the penetration."""
        return bool(self._transmissions or self._deflections or self._springs)

    def penetration(self, t: Any, x: Any, v: Any, states: Any, m: Any) -> tuple[Any, Any, Any]:
        """Return d [m], its rate [m/s] and engagement at the wall for a tip at x, v (N,)."""
        d, engaged = x - self._x_e, True
        for effect, place in self._surfaces:
            shift, rate = effect.surface(t, states[place], m)
            d, v = d - shift, v - rate
        for effect, place in self._transmissions:
            d, v, engaged = effect.transmit(d, v, states[place], m)
        return d, v, engaged

    def travel(self, t: Any, x: Any, states: Any, m: Any) -> Any:
        """Return the penetration of the tool itself [m]; parameters as `penetration`."""
        d = x - self._x_e
        for effect, place in self._surfaces:
            d = d - effect.surface(t, states[place], m)[0]
        return d

    def touch(self, t: Any, x: Any, v: Any, states: Any, m: Any) -> Touch:
        """Evaluate the law without inertia; parameters as `penetration`."""
        if self._is_plain and not self._tails:
            d = x - self._x_e
            contact = d > 0.0 if self.unilateral else True
            return Touch(contact, self.stiffness * d + self.damping * v, 0.0)
        d, v, engaged = self.penetration(t, x, v, states, m)
        return self._touch(t, d, v, engaged, states, m)

    def _touch(self, t: Any, d: Any, v: Any, engaged: Any, states: Any, m: Any) -> Touch:
        contact = (d > 0.0) & engaged if self.unilateral else engaged
        return Touch(contact, self._resistance(t, d, v, states, m), self.tail(d, v, states, m))

    def tail(self, d: Any, v: Any, states: Any, m: Any) -> Any:
        """Return F_e out of contact [N]; parameters as `penetration`, at the wall."""
        free: Any = 0.0
        for effect, place in self._tails:
            free = free + effect.tail(d, v, states[place], m)
        return free

    def _resistance(self, t: Any, d: Any, v: Any, states: Any, m: Any) -> Any:
        spring, damper = self._spring(self.stiffness, t, d, m), self.damping * v
        for effect, _ in self._dampers:
            damper = effect.damper(d, v, self._exponent, m)
        resistance = spring + damper
        for effect, _ in self._carriers:
            resistance = effect.carried(d, spring, damper, m)
        resistance = self._with_elastics(resistance, d, m)
        for effect, place in self._resistances:
            u, rate = self._relaxing(t, d, v, m) if effect.relaxes else (d, v)
            resistance = resistance + effect.resistance(t, u, rate, states[place], m)
        return resistance

    def _relaxing(self, t: Any, d: Any, v: Any, m: Any) -> tuple[Any, Any]:
        """Return d and v at which the spring K_e alone has the elastic force."""
        if not self._bends:
            return d, v
        near = _NEAR * abs(d) + _LEAST_NEAR
        below, here, above = (
            self._with_elastics(self._spring(self._usual, t, there, m), there, m) / self._usual
            for there in (d - near, d, d + near))
        return here, (above - below) / (2.0 * near) * v

    def _spring(self, stiffness: float, t: Any, d: Any, m: Any) -> Any:
        """Return the force of the spring, or of what is in its place [N]."""
        deflection = d
        for effect, _ in self._deflections:
            deflection = effect.deflection(t, deflection, m)
        spring = stiffness * deflection
        for effect, _ in self._springs:
            spring = effect.spring(d, m)
        return spring

    def _with_elastics(self, force: Any, d: Any, m: Any) -> Any:
        """Add the elastic forces beside the spring [N]."""
        for effect, _ in self._elastics:
            force = force + effect.elastic(d, m)
        return force

    def resistance(self, t: Any, x: Any, v: Any, states: Any, m: Any) -> Any:
        """Return the resistance in contact without inertia [N]; parameters as `penetration`."""
        if self._is_plain:
            return self.stiffness * (x - self._x_e) + self.damping * v
        d, v, _ = self.penetration(t, x, v, states, m)
        return self._resistance(t, d, v, states, m)

    def rates(self, t: float, x: float, v: float, states: State) -> State:
        """Return the rates of the internal states; parameters as `penetration`."""
        rates: State = ()
        for effect, place, touching, d, u in self._met(t, x, v, states):
            rates += effect.state_rates(t, d, u, touching, states[place])
        return rates

    def settle(self, t: float, x: float, v: float, states: State) -> State:
        """Project the internal states onto their range; parameters as `penetration`."""
        settled: State = ()
        for effect, place, touching, d, u in self._met(t, x, v, states):
            settled += effect.settle(d, u, touching, states[place])
        return settled

    def _met(self, t: float, x: float, v: float, states: State) -> list[tuple[Any, ...]]:
        """Return the effects with states, and contact, d and v before their own change of them."""
        own: dict[int, tuple[float, float]] = {}
        d = x - self._x_e
        for effect, place in self._surfaces:
            own.setdefault(id(effect), (d, v))
            shift, rate = effect.surface(t, states[place], math)
            d, v = d - shift, v - rate
        for effect, place in self._transmissions:
            own.setdefault(id(effect), (d, v))
            d, v, _ = effect.transmit(d, v, states[place], math)
        met = []
        for effect, place in self._stateful:
            u, rate = own.get(id(effect), (d, v))
            touching = u > 0.0 or not self.unilateral
            if effect.relaxes:
                u, rate = self._relaxing(t, u, rate, math)
            met.append((effect, place, touching, u, rate))
        return met

    def motion_along(self, t: Array, x: Array, v: Array) -> WallMotion:
        """Integrate all internal states along a recorded motion, evenly spaced (N,)."""
        moving = [place[0] for place in (*self._surfaces, *self._transmissions, *self._stateful)]
        if not moving:
            return WallMotion(StatesAlong(), x - self._x_e, v, True)
        bends = self._bends if any(effect.relaxes for effect in moving) else []
        law = (self._x_e, self.unilateral, float(t[1] - t[0]), self._usual if bends else 0.0,
               tuple(_shaping(effect) for effect in (*moving, *bends)))
        return _KEPT.along(law, x, v, lambda: self._moved(t, x, v))

    def _moved(self, t: Array, x: Array, v: Array) -> WallMotion:
        states, engaged = StatesAlong(), True
        d = x - self._x_e
        known: set[int] = set()
        for effect, place in self._surfaces:
            if effect.states:
                states[place] = effect.states_along(t, d, v, self._touching(d))
                known.add(id(effect))
            shift, rate = effect.surface(t, states[place], np)
            d, v = d - shift, v - rate
        for effect, place in self._transmissions:
            if effect.states and id(effect) not in known:
                states[place] = effect.states_along(t, d, v, self._touching(d))
                known.add(id(effect))
            d, v, engaged = effect.transmit(d, v, states[place], np)
        for effect, place in self._stateful:
            if id(effect) not in known:
                u, rate = self._relaxing(t, d, v, np) if effect.relaxes else (d, v)
                states[place] = effect.states_along(t, u, rate, self._touching(d))
        return WallMotion(states, d, v, engaged)

    def _touching(self, d: Array) -> NDArray[np.bool_]:
        return d > 0.0 if self.unilateral else np.ones(len(d), bool)

    def force_and_depth(self, t: Array, x: Array, v: Array, a: Array) -> tuple[Array, Array]:
        """Predict F_e [N] and d [m] from a recorded motion, evenly spaced (N,)."""
        states, d, rate, engaged = self.motion_along(t, x, v)
        touch = self._touch(t, d, rate, engaged, states, np)
        pressing = -(touch.resistance + self.inertia * a if self.inertia else touch.resistance)
        if not self.unilateral:
            return np.where(touch.contact, pressing, 0.0), d
        held = np.where(touch.contact, np.minimum(self.pull, pressing), touch.free_force)
        return held, d

    def force(self, t: Array, x: Array, v: Array, a: Array) -> Array:
        """Return F_e alone; see `force_and_depth`."""
        return self.force_and_depth(t, x, v, a)[0]

    def contact(self, t: Array, x: Array, v: Array) -> NDArray[np.bool_]:
        """Return where d > 0, (N,); parameters as `force_and_depth`."""
        return np.asarray(self.motion_along(t, x, v).d > 0.0)


@lru_cache(maxsize=None)
def _users_of_hooks(
    kinds: tuple[type[ContactEffect], ...],
) -> tuple[tuple[tuple[int, ...], ...], bool]:
    """Return for each hook which effects override it, and whether none does but for a tail."""
    changed = [kind.changes.intersection(_HOOKS) for kind in kinds]
    users = tuple(tuple(k for k, hooks in enumerate(changed) if hook in hooks) for hook in _HOOKS)
    return users, not any(hooks - {'tail'} for hooks in changed)


def _shaping(effect: ContactEffect) -> tuple[type, tuple[float, ...]]:
    """Return an effect's type and the values on which its states and motion depend."""
    return type(effect), tuple(
        value for name, value in effect.values().items() if name not in effect.weights)
