# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base classes of laws of the literature, independent of the effects of the library."""

from math import sqrt
from types import SimpleNamespace
from typing import Any, Callable, ClassVar, Mapping, NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Array = NDArray[np.float64]
Values = Mapping[str, float]
"""Parameters of a law by name."""

Reply = tuple[float, Any]
"""A force [N] and the state of the law after this step."""

Strength = Callable[[float], Values]
"""From a magnitude, 0 (absent) to 1 (largest plausible), to the parameters of a law."""


class Magnitudes(NamedTuple):
    """Orders of magnitude in a world, from which a law is drawn."""

    # depth, speed, force, control: largest penetration [m], its rate [m/s], largest contact force
    # and control force [N]
    depth: float
    speed: float
    force: float
    control: float
    duration: float  # length of the experiment [s]
    # stiffness, damping, mass: K_e [N/m], B_e [N s/m] and moving mass [kg] of the world
    stiffness: float
    damping: float
    mass: float


class Signals(NamedTuple):
    """True signals along an experiment, of shape (N,) each."""

    # t, x, v, a, force: time, evenly spaced [s], motion of the end-effector [m], [m/s], [m/s^2]
    # and F_e [N]
    t: Array
    x: Array
    v: Array
    a: Array
    force: Array

    @property
    def dt(self) -> float:
        """Time between samples [s]."""
        return float(self.t[1] - self.t[0])


class Compliance(NamedTuple):
    """A tip on a spring and a damper in front of the body whose position is measured."""

    # mass, stiffness, damping: of the tip [kg], of spring [N/m] and damper [N s/m]
    mass: float
    stiffness: float
    damping: float


class ForeignLaw:
    """
    A law that is not in the vocabulary of the diagnosis; a base class itself is no law at all.

    values: parameters by name
    """

    port: ClassVar[str] = ''  # where the law acts: 'contact', 'force_sensor' or 'robot'
    # families of effects that describe it acceptably; empty where none does
    families: ClassVar[tuple[str, ...]] = ()
    # experiments in which the law shows: 'press' (robot with reference), 'specimen' (attached,
    # seconds), 'slow' (attached, minutes), 'drive' (attached mass)
    stages: ClassVar[tuple[str, ...]] = ('press', 'specimen')

    def __init__(self, values: Values) -> None:
        self.values: Any = SimpleNamespace(**values)

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        """Draw everything but the magnitude at random, in a world of given magnitudes."""
        raise NotImplementedError

    def compliance(self) -> Compliance | None:
        """Return the compliance between measured position and contact, None without."""
        return None


class YieldingLaw(ForeignLaw):
    """A law of a `Compliance`, whose mass is between two shares of that of the robot."""

    shares: ClassVar[tuple[float, float]]

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        mass = m.mass * log_uniform(rng, *cls.shares)
        softest = 0.5 / m.stiffness
        ratio = float(rng.uniform(0.05, 0.3))
        return lambda s: {'mass': mass, 'stiffness': 1.0 / (max(s, 1e-6) * softest),
                          'damping': 2.0 * ratio * sqrt(mass / (max(s, 1e-6) * softest))}

    def compliance(self) -> Compliance:
        return Compliance(**vars(self.values))


class ContactLaw(ForeignLaw):
    """
    A law of the contact: F_e = -(K_e d + B_e v + R) with R a function of t, d, v and own state.

    A law without memory overrides `force`, one with memory `respond`.
    """

    port = 'contact'
    # keeps_spring, keeps_damper: whether K_e d and B_e v remain beside R
    keeps_spring: ClassVar[bool] = True
    keeps_damper: ClassVar[bool] = True
    pulls: ClassVar[bool] = False  # whether a unilateral contact may pull
    # state at the beginning and, unless `release` says otherwise, out of contact
    rest: ClassVar[Any] = None

    def start(self, dt: float, count: int) -> Any:
        """Return the state at the beginning, `count` steps of `dt` [s] to come."""
        return self.rest

    def surface(self, t: float) -> tuple[float, float]:
        """Return displacement [m] and velocity [m/s] of the surface at time t [s]."""
        return 0.0, 0.0

    def force(self, t: float, d: float, v: float) -> float:
        """Return R [N] at time t [s], penetration d [m] and its rate v [m/s]."""
        return 0.0

    def respond(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        """Return R [N] and the state after a step dt [s] in contact; R resists penetration."""
        return self.force(t, d, v), state

    def release(self, t: float, d: float, v: float, dt: float, state: Any) -> Reply:
        """Return F_e [N] and the state after a step out of contact, d <= 0."""
        return 0.0, self.rest


class SensorLaw(ForeignLaw):
    """A law of the force sensor."""

    port = 'force_sensor'

    def sense(self, signals: Signals) -> Array:
        """Return the measured force [N], shape (N,), of true signals."""
        return signals.force


class RobotLaw(ForeignLaw):
    """A law of the robot."""

    port = 'robot'
    stages = ('press',)

    def follow(self, t: Array, reference: Array) -> Array:
        """Return x_r, its rate and acceleration, shape (N, 3), as the controller receives them."""
        return reference

    def drive(self, u: float, x: float, v: float, dt: float, state: Any) -> Reply:
        """
        Return the force that drives the robot's mass [N], less friction, and the state.

        u: force commanded by the impedance law [N]; x, v: position [m] and velocity [m/s]; dt:
        time since the last call [s]; state: after the last call, 0.0 at first
        """
        return u, state


def log_uniform(rng: Generator, low: float, high: float) -> float:
    """Draw a number > 0 whose logarithm is uniformly distributed over a range."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def sign(value: float) -> float:
    """Return -1, 0 or 1."""
    return float((value > 0.0) - (value < 0.0))
