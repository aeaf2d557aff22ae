# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Simulation of a rig: a world with nuisances, under a law of the literature or none."""

from functools import lru_cache
from math import pi
from typing import Any, Callable, NamedTuple

import numpy as np
from numpy.random import Generator
from scipy.signal import lfilter

from .foreign_law import Compliance, ContactLaw, ForeignLaw, RobotLaw, SensorLaw, Signals
from .world import Array, Nuisances, Run, World
from ...plant.plant_parameters import RobotParameters
from ...reference.experiment import Experiment

_COMMAND_HZ = 1000.0  # most rapid stream of commands; straight lines between them
_BEND_M = 1e-5  # elastic motion before the friction of the robot slips

Contact = Callable[[float, float, float], float]
"""From t [s], x [m] and v [m/s] to F_e [N], called once a step."""


def _disturbed(t: Array, x: Array, force: Array, n: Nuisances, rng: Generator) -> Array:
    """Add bias, cable, hum and coloured noise to a measured force (N,) [N]."""
    rate = 1.0 / float(t[1] - t[0])
    fade = float(np.exp(-2.0 * pi * min(n.colour_corner, 0.2 * rate) / rate))
    white = rng.standard_normal(len(t)) * n.colour * (1.0 - fade**2) ** 0.5
    hum = n.hum * np.sin(2.0 * pi * n.hum_frequency * t)
    slow = rate > 4.0 * n.hum_frequency  # else the sensor averages over the mains period
    return np.asarray(force + n.bias - n.cable * (x - x[0]) + (hum if slow else 0.0)
                      + lfilter([1.0], [1.0, -fade], white))


class _Motion(NamedTuple):
    """Signals of shape (N,) under the integration."""

    x: Array
    v: Array
    force: Array


def simulate_rig(rig: World, law: ForeignLaw, rate: float, rng: Generator) -> Run:
    """Simulate the experiment of a rig under a law at a rate of steps [Hz]."""
    t, planned = _planned_motion(rig.experiment, rate)
    if rig.robot is None:
        motion = _prescribed(rig, law, t, planned)
        planned = np.zeros_like(planned)
    else:
        motion = _pressed(rig, rig.robot, law, t, planned)
    with np.errstate(invalid='ignore'):  # a law that is too strong diverges; it is not usable
        a: Array = np.gradient(motion.v, t)
    own = law if isinstance(law, SensorLaw) else SensorLaw({})
    sensed = own.sense(Signals(t, motion.x, motion.v, a, motion.force))
    return Run(t, motion.x, motion.v, motion.force,
               _disturbed(t, motion.x, sensed, rig.nuisances, rng), *planned.T)


@lru_cache(maxsize=2)  # of the search and of the recording
def _planned_motion(experiment: Experiment, rate: float) -> tuple[Array, Array]:
    """Sample an experiment at a rate [Hz]: times (N,) [s], position and derivatives (N, 3)."""
    t: Array = np.arange(int(experiment.duration * rate + 1e-6) + 1) / rate
    coarse: Array = t if rate <= _COMMAND_HZ else np.arange(
        int(experiment.duration * _COMMAND_HZ) + 2) / _COMMAND_HZ
    rows = []
    for instant in coarse.tolist():
        desired = experiment.desired(instant)
        rows.append((desired.position, desired.velocity, desired.acceleration))
    return t, np.column_stack([np.interp(t, coarse, column) for column in np.array(rows).T])


# -- contact --------------------------------------------------------------------------------


def _contact(rig: World, law: ForeignLaw, dt: float, count: int) -> Contact:
    """Return F_e as a function of t, x and v, called once a step."""
    own = law if isinstance(law, ContactLaw) else ContactLaw({})
    wall, cubic = rig.wall, rig.nuisances.cubic / rig.depth**2
    K = wall.stiffness if own.keeps_spring else 0.0
    B = wall.damping if own.keeps_damper else 0.0
    K_3, x_e, attached = cubic * wall.stiffness, wall.location, not wall.unilateral
    state: Any = own.start(dt, count)
    moves = type(own).surface is not ContactLaw.surface
    pulls = attached or own.pulls

    def force(t: float, x: float, v: float) -> float:
        nonlocal state
        d = x - x_e
        if moves:
            shift, rate = own.surface(t)
            d, v = d - shift, v - rate
        if d <= 0.0 and not attached:
            pull, state = own.release(t, d, v, dt, state)
            return pull
        further, state = own.respond(t, d, v, dt, state)
        resistance = K * d + B * v + K_3 * d * d * d + further
        return -resistance if pulls or resistance > 0.0 else 0.0

    return force


def _prescribed(rig: World, law: ForeignLaw, t: Array, planned: Array) -> _Motion:
    """Evaluate the force of an attached specimen under a prescribed motion."""
    x, v, a = planned.T
    force = _contact(rig, law, float(t[1]), len(t))
    held = [force(*row) for row in zip(t.tolist(), x.tolist(), v.tolist())]
    return _Motion(x, v, np.array(held) - rig.wall.inertia * a)


# -- robot ----------------------------------------------------------------------------------


def _pressed(
    rig: World, robot: RobotParameters, law: ForeignLaw, t: Array, planned: Array
) -> _Motion:
    """
    Integrate M_t xdd = drive(u) + F_e with u of eq. (1) by the leapfrog scheme.

    Forces are evaluated once a step, at its middle, with the velocity extrapolated to there: laws
    with memory (relays, sliders) have no rates that a Runge-Kutta method could evaluate.
    """
    h = float(t[1])
    own = law if isinstance(law, RobotLaw) else RobotLaw({})
    contact, tip = _contact(rig, law, h, len(t)), law.compliance()
    most, friction = rig.nuisances.robot_friction, 0.0
    state: Any = 0.0
    M, B, K = robot.mass, robot.damping, robot.stiffness
    start = float(planned[0, 0])
    body = _Rigid(M, contact, start) if tip is None else _Flexible(M, tip, contact, start)
    rows = []
    for instant, (x_r, v_r, a_r) in zip(t.tolist(), own.follow(t, planned).tolist()):
        x, v = body.middle(h)
        friction = min(most, max(-most, friction + most / _BEND_M * v * h))
        u, state = own.drive(M * a_r - B * (v - v_r) - K * (x - x_r), x, v, h, state)
        rows.append((x, v, body.step(instant, h, u - friction)))
    return _Motion(*np.array(rows).T)


class _Rigid:
    """A body whose measured position touches the wall."""

    def __init__(self, mass: float, contact: Contact, x: float) -> None:
        self._mass, self._contact = mass, contact
        self._x, self._v, self._a = x, 0.0, 0.0

    def middle(self, h: float) -> tuple[float, float]:
        """Advance by half a step of h [s]; return position and extrapolated velocity."""
        self._x += 0.5 * h * self._v
        return self._x, self._v + 0.5 * h * self._a

    def step(self, t: float, h: float, drive: float) -> float:
        """Finish the step under a driving force [N]; return F_e [N]."""
        force = self._contact(t, self._x, self._v + 0.5 * h * self._a)
        self._a = (drive + force) / self._mass
        self._v += h * self._a
        self._x += 0.5 * h * self._v
        return force


class _Flexible(_Rigid):
    """A body in front of which a tip on a spring touches the wall."""

    def __init__(self, mass: float, tip: Compliance, contact: Contact, x: float) -> None:
        super().__init__(mass - tip.mass, contact, x)
        self._tip = tip
        self._y, self._w, self._b = x, 0.0, 0.0

    def middle(self, h: float) -> tuple[float, float]:
        self._y += 0.5 * h * self._w
        return super().middle(h)

    def step(self, t: float, h: float, drive: float) -> float:
        tip, v, w = self._tip, self._v + 0.5 * h * self._a, self._w + 0.5 * h * self._b
        force = self._contact(t, self._y, w)
        spring = tip.stiffness * (self._x - self._y) + tip.damping * (v - w)
        self._a = (drive - spring) / self._mass
        self._b = (spring + force) / tip.mass
        self._v, self._w = self._v + h * self._a, self._w + h * self._b
        self._x, self._y = self._x + 0.5 * h * self._v, self._y + 0.5 * h * self._w
        return force
