# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Robots."""

from math import exp, pi, sin, tanh
from typing import Any

import numpy as np
from numpy.random import Generator

from .foreign_law import (
    Array, log_uniform, Magnitudes, Reply, RobotLaw, Strength, YieldingLaw)


class FlexibleJoint(YieldingLaw, RobotLaw):
    """
    The link follows the motor through the elasticity of the gear.

    Motor: (M_t - m) x'' = u - k (x - y) - c (x' - y').
    Link: m y'' = k (x - y) + c (x' - y') + F_e.
    Spong, J. Dynamic Systems, Measurement, and Control 109(4), 1987.
    """

    families = ('robot', 'inertia', 'timing', 'relaxation')
    shares = 0.2, 0.5


class JointFriction(RobotLaw):
    """
    Coulomb friction of a gear with a wave of its teeth or of an eccentric seal.

    Friction F_c (1 + wave sin(2 pi x / pitch)) against the motion, reached over a short bend.
    Armstrong-Helouvry, Control of Machines with Friction, 1991 (position dependence).
    """

    families = ('robot',)

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        F_c = 0.3 * m.force
        wave = float(rng.uniform(0.2, 0.6))
        pitch = m.depth * log_uniform(rng, 0.3, 2.0)
        stiffness = F_c / (2e-3 * m.depth)
        return lambda s: {'F_c': s * F_c, 'wave': wave, 'pitch': pitch, 'stiffness': s * stiffness}

    def drive(self, u: float, x: float, v: float, dt: float, state: Any) -> Reply:
        p = self.values
        most = p.F_c * (1.0 + p.wave * sin(2.0 * pi * x / p.pitch))
        friction = min(most, max(-most, state + p.stiffness * v * dt))
        return u - friction, friction


class StribeckJoint(RobotLaw):
    """
    Friction of a lubricated gear.

    Friction (F_c + F_s exp(-abs(v / v_s))) sgn(v) + F_v sgn(v) abs(v / v_t)^0.7, sgn(v) smoothed.
    Bona and Indri, Proc. IEEE Conf. Decision and Control, 2005; Bittencourt and
    Gunnarsson, J. Dynamic Systems, Measurement, and Control 134(5), 2012.
    """

    families = ('robot',)

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        share, v_s = float(rng.uniform(0.1, 0.6)), m.speed * log_uniform(rng, 0.05, 0.3)
        F_c, F_v = 0.3 * m.force, 0.1 * m.force
        return lambda s: {'F_c': s * F_c, 'F_s': s * share * F_c, 'v_s': v_s, 'F_v': s * F_v,
                          'v_t': m.speed}

    def drive(self, u: float, x: float, v: float, dt: float, state: Any) -> Reply:
        p, speed = self.values, abs(v)
        most = p.F_c + p.F_s * exp(-speed / p.v_s) + p.F_v * (speed / p.v_t) ** 0.7
        return u - most * tanh(v / (0.03 * p.v_t)), state


class SampledCommand(RobotLaw):
    """
    The robot holds each command until the next one, which comes late.

    The reference at t is that of delay + period floor((t - delay) / period) - delay.
    Astrom and Wittenmark, Computer-Controlled Systems, 1997 (hold circuits).
    """

    families = ('timing',)

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        late = float(rng.uniform(0.2, 1.0))
        return lambda s: {'period': 0.1 * s, 'delay': 0.1 * s * late}

    def follow(self, t: Array, reference: Array) -> Array:
        p = self.values
        sent = p.period * np.floor((t - p.delay) / p.period)
        return np.column_stack([np.interp(sent, t, column) for column in reference.T])


class SlowTorqueLoop(RobotLaw):
    """
    The drives deliver the commanded force through a loop of the second order.

    tau^2 f'' + 2 zeta tau f' + f = u.
    Pratt and Williamson, Proc. IEEE/RSJ Int. Conf. Intelligent Robots and Systems, 1995 (series
    elastic actuators).
    """

    families = ('timing', 'robot', 'inertia')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        zeta = float(rng.uniform(0.4, 1.0))
        return lambda s: {'tau': max(0.05 * s, 5e-4), 'zeta': zeta}

    def drive(self, u: float, x: float, v: float, dt: float, state: Any) -> Reply:
        tau, zeta = self.values.tau, self.values.zeta
        f, rate = state or (u, 0.0)
        # Implicit in f and its rate: stable for loops far faster than a step.
        damping, spring = 2.0 * zeta / tau, 1.0 / tau**2
        rate = (rate + dt * spring * (u - f)) / (1.0 + dt * damping + dt**2 * spring)
        f += dt * rate
        return f, (f, rate)


class SoftTorqueLimit(RobotLaw):
    """
    A magnetic circuit that saturates gradually.

    f = u / (1 + abs(u / limit)^4)^(1/4).
    Krause, Wasynczuk and Sudhoff, Analysis of Electric Machinery, 2002 (saturation).
    """

    families = ('limits', 'robot')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        control = m.control
        return lambda s: {'limit': control / (1.5 * max(s, 1e-6))}

    def drive(self, u: float, x: float, v: float, dt: float, state: Any) -> Reply:
        return u / (1.0 + (u / self.values.limit) ** 4) ** 0.25, state


class Windage(RobotLaw):
    """
    Aerodynamic or churning drag.

    Drag c v abs(v).
    Batchelor, An Introduction to Fluid Dynamics, 1967.
    """

    families = ('robot',)

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        c = 2.0 * m.control / m.speed**2
        return lambda s: {'c': s * c}

    def drive(self, u: float, x: float, v: float, dt: float, state: Any) -> Reply:
        return u - self.values.c * v * abs(v), state


class CoggingTorque(RobotLaw):
    """
    A torque that pulls towards the slots of the motor.

    Force amplitude sin(2 pi x / pitch) beside that of the drives.
    Jahns and Soong, IEEE Trans. Industrial Electronics 43(2), 1996 (cogging).
    """

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        pitch = m.depth / float(rng.uniform(2.0, 5.0))
        return lambda s: {'amplitude': 0.3 * s * m.force, 'pitch': pitch}

    def drive(self, u: float, x: float, v: float, dt: float, state: Any) -> Reply:
        return u + self.values.amplitude * sin(2.0 * pi * x / self.values.pitch), state
