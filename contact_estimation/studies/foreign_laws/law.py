# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base classes of laws of the literature, independent of the effects of the library."""

from __future__ import annotations

from abc import ABC, abstractmethod
from types import SimpleNamespace
from typing import Any, Callable, ClassVar, Mapping, NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Array = NDArray[np.float64]
Values = Mapping[str, float]
"""Parameters of a law by name."""

Strength = Callable[[float], Values]
"""From a magnitude, 0 (absent) to 1 (largest plausible), to the parameters of a law."""


class Magnitudes(NamedTuple):
    """
    Orders of magnitude in a world, from which a law is drawn.

    Attributes
    ----------
    depth, speed, force, control : float
        Largest penetration [m], its rate [m/s], largest contact force and control force [N].
    duration : float
        Length of the experiment [s].
    stiffness, damping, mass : float
        K_e [N/m], B_e [N s/m] and moving mass [kg] of the world.

    """

    depth: float
    speed: float
    force: float
    control: float
    duration: float
    stiffness: float
    damping: float
    mass: float


class Signals(NamedTuple):
    """
    True signals along an experiment, of shape (N,) each.

    Attributes
    ----------
    t, x, v, a, force : ndarray
        Time, evenly spaced [s], motion of the end-effector [m], [m/s], [m/s^2] and F_e [N].

    """

    t: Array
    x: Array
    v: Array
    a: Array
    force: Array


class Compliance(NamedTuple):
    """
    A tip on a spring and a damper in front of the body whose position is measured.

    Attributes
    ----------
    mass, stiffness, damping : float
        Of the tip [kg], of spring [N/m] and damper [N s/m].

    """

    mass: float
    stiffness: float
    damping: float


class ForeignLaw(ABC):
    """
    A law that is not in the vocabulary of the diagnosis.

    Attributes
    ----------
    port : str
        Where the law acts: 'contact', 'force_sensor' or 'robot'.
    families : tuple of str
        Families of effects that describe it acceptably; empty where none does.
    stages : tuple of str
        Experiments in which the law shows: 'press' (robot with reference), 'specimen' (attached,
        seconds), 'slow' (attached, minutes), 'drive' (attached mass).

    Parameters
    ----------
    values : mapping
        Parameters by name.

    """

    port: ClassVar[str]
    families: ClassVar[tuple[str, ...]] = ()
    stages: ClassVar[tuple[str, ...]] = ('press', 'specimen')

    def __init__(self, values: Values) -> None:
        self.values: Any = SimpleNamespace(**values)

    @classmethod
    @abstractmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """
        Draw everything but the magnitude at random.

        Parameters
        ----------
        magnitudes : Magnitudes
            Orders of magnitude in the world.
        rng : numpy.random.Generator
            Random generator.

        Returns
        -------
        strength : callable
            From a magnitude, 0 to 1, to the parameters.

        """

    def compliance(self) -> Compliance | None:
        """Return the compliance between measured position and contact, None without."""
        return None


class ContactLaw(ForeignLaw):
    """
    A law of the contact: F_e = -(K_e d + B_e v + R) with R a function of t, d, v and own state.

    Attributes
    ----------
    keeps_spring, keeps_damper : bool
        Whether K_e d and B_e v remain beside R.
    pulls : bool
        Whether a unilateral contact may pull.

    """

    port = 'contact'
    keeps_spring: ClassVar[bool] = True
    keeps_damper: ClassVar[bool] = True
    pulls: ClassVar[bool] = False

    def start(self, dt: float, count: int) -> Any:
        """
        Return the state at the beginning.

        Parameters
        ----------
        dt : float
            Step [s].
        count : int
            Number of steps to come.

        Returns
        -------
        state : object
            None for a law without memory.

        """
        return None

    def surface(self, t: float) -> tuple[float, float]:
        """Return displacement [m] and velocity [m/s] of the surface at time t [s]."""
        return 0.0, 0.0

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """
        Return the force in contact.

        Parameters
        ----------
        t, d, v : float
            Time [s], penetration [m] and its rate [m/s].
        dt : float
            Time since the last call [s].
        state : object
            State after the last call.

        Returns
        -------
        R : float
            Force [N], positive where it resists penetration.
        state : object
            State after this step.

        """
        return 0.0, state

    def release(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """
        Return the force out of contact, d <= 0; parameters as `respond`.

        Returns
        -------
        pull : float
            F_e [N].
        state : object
            State after this step.

        """
        return 0.0, state


class SensorLaw(ForeignLaw):
    """A law of the force sensor."""

    port = 'force_sensor'

    @abstractmethod
    def sense(self, signals: Signals) -> Array:
        """
        Return the measured force.

        Parameters
        ----------
        signals : Signals
            True signals.

        Returns
        -------
        force : ndarray, shape (N,)
            Measured F_e [N].

        """


class RobotLaw(ForeignLaw):
    """A law of the robot."""

    port = 'robot'
    stages = ('press',)

    def follow(self, t: Array, reference: Array) -> Array:
        """
        Return the reference that reaches the controller.

        Parameters
        ----------
        t : ndarray, shape (N,)
            Time [s].
        reference : ndarray, shape (N, 3)
            x_r, its rate and acceleration as sent.

        Returns
        -------
        reference : ndarray, shape (N, 3)
            As received.

        """
        return reference

    def drive(
        self, u: float, x: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """
        Return the force that drives the robot's mass.

        Parameters
        ----------
        u : float
            Force commanded by the impedance law [N].
        x, v : float
            Position [m] and velocity [m/s].
        dt : float
            Time since the last call [s].
        state : object
            State after the last call, 0.0 at first.

        Returns
        -------
        force : float
            Delivered force less friction [N].
        state : object
            State after this step.

        """
        return u, state


def log_uniform(rng: Generator, low: float, high: float) -> float:
    """Draw a number > 0 whose logarithm is uniformly distributed over a range."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def sign(value: float) -> float:
    """Return -1, 0 or 1."""
    return float((value > 0.0) - (value < 0.0))
