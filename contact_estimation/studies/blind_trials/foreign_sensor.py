# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Force sensors."""

from math import pi
from typing import Sequence

import numpy as np
from numpy.random import Generator
from scipy.signal import bilinear, lfilter

from .foreign_law import (
    Array, log_uniform, Magnitudes, SensorLaw, Signals, Strength, YieldingLaw)


def filtered(
    values: Array, dt: float, numerator: Sequence[float], denominator: Sequence[float],
    origin: float = 0.0,
) -> Array:
    """
    Filter a signal by a transfer function of s, discretised by the trapezoidal rule.

    numerator, denominator: coefficients of the powers of s, highest first
    origin: value of the signal before the first sample, at which the filter rests
    """
    b, a = bilinear(numerator, denominator, 1.0 / dt)
    rest = origin * numerator[-1] / denominator[-1]
    return np.asarray(lfilter(b, a, values - origin)) + rest


def low_passed(values: Array, dt: float, omega: float, zeta: float, origin: float = 0.0) -> Array:
    """Filter a signal by a low-pass of second order, of angular frequency [rad/s] and damping."""
    return filtered(values, dt, [omega**2], [1.0, 2.0 * zeta * omega, omega**2], origin)


class SecondOrderFilter(SensorLaw):
    """
    A low-pass filter of second order whose delay nobody subtracts.

    y'' + 2 zeta omega y' + omega^2 y = omega^2 F_e.
    Oppenheim and Willsky, Signals and Systems, 1997.
    """

    families = ('timing',)

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        zeta = float(rng.uniform(0.5, 1.0))
        return lambda s: {'period': 0.5 * s, 'zeta': zeta}

    def sense(self, signals: Signals) -> Array:
        omega = 2.0 * pi / self.values.period
        return low_passed(
            signals.force, signals.dt, omega, self.values.zeta, float(signals.force[0]))


class SettlingBias(SensorLaw):
    """
    A bias that approaches a constant exponentially.

    y = F_e + bias + warm exp(-t / tau).
    Fraden, Handbook of Modern Sensors, 2016 (warm-up time).
    """

    families = ('sensor_zero',)

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        tau = m.duration * log_uniform(rng, 0.1, 0.6)
        warm = m.force * float(rng.choice([-0.5, 0.5]))
        ratio = float(rng.uniform(-0.8, 0.8))
        return lambda s: {'bias': s * ratio * warm, 'warm': s * warm, 'tau': tau}

    def sense(self, signals: Signals) -> Array:
        p = self.values
        return signals.force + p.bias + p.warm * np.exp(-signals.t / p.tau)


class LoadCellCreep(SensorLaw):
    """
    A share of the force appears slowly, as of a creeping glue of strain gauges.

    y = F_e + share (F_e low-passed by 1 / (tau s + 1)).
    Bartel and Yaniv, J. Research of the National Bureau of Standards 102(3), 1997.
    """

    families = ('relaxation',)
    stages = ('press', 'specimen', 'slow')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        tau = m.duration * log_uniform(rng, 0.02, 0.1)
        way = float(rng.choice([-0.4, 0.4]))
        return lambda s: {'share': s * way, 'tau': tau}

    def sense(self, signals: Signals) -> Array:
        p = self.values
        return signals.force + p.share * filtered(signals.force, signals.dt, [1.0], [p.tau, 1.0])


class SoftClipping(SensorLaw):
    """
    A force sensor whose reading bends towards a limit.

    y = limit tanh(F_e / limit).
    Yeh, Abel and Smith, Proc. Digital Audio Effects, 2007 (saturating amplifiers).
    """

    families = ('limits', 'sensor_gain', 'elastic_law')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        force = m.force
        return lambda s: {'limit': force / (1.5 * max(s, 1e-6))}

    def sense(self, signals: Signals) -> Array:
        return np.asarray(self.values.limit * np.tanh(signals.force / self.values.limit))


class PowerCharacteristic(SensorLaw):
    """
    A force sensor calibrated at one force, whose reading is a power of the force.

    y = F_e (|F_e| / F_0)^(n - 1).
    Interlink Electronics, FSR Integration Guide, 2010 (resistance of a pressed film).
    On an attached specimen it is the same as a spring that bends: only the motion of a robot,
    which feels the true force, tells the two apart.
    """

    families = ('sensor_gain',)
    stages = ('press',)

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        change, force = float(rng.choice([-0.4, 0.6])), 0.5 * m.force
        return lambda s: {'exponent': 1.0 + s * change, 'force': force}

    def sense(self, signals: Signals) -> Array:
        ratio = np.abs(signals.force) / self.values.force
        return np.sign(signals.force) * self.values.force * ratio ** self.values.exponent


class MainsHum(SensorLaw):
    """
    Interference at the mains frequency and its harmonics.

    y = F_e + amplitude (sin(omega t) + second sin(2 omega t) + third sin(3 omega t)), each
    with its phase.
    Ott, Electromagnetic Compatibility Engineering, 2009 (grounding).
    """

    stages = ('press', 'specimen', 'drive')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        mains = float(rng.choice([50.0, 60.0])) * float(rng.uniform(0.998, 1.002))
        second, third = float(rng.uniform(0.0, 0.4)), float(rng.uniform(0.1, 0.6))
        phase = float(rng.uniform(0.0, 2.0 * pi))
        return lambda s: {'amplitude': 0.3 * s * m.force, 'mains': mains,
                          'second': second, 'third': third, 'phase': phase}

    def sense(self, signals: Signals) -> Array:
        p, angle = self.values, 2.0 * pi * self.values.mains * signals.t + self.values.phase
        hum = np.sin(angle) + p.second * np.sin(2.0 * angle + 1.0) + p.third * np.sin(3.0 * angle)
        return np.asarray(signals.force + p.amplitude * hum)


class CrossTalk(SensorLaw):
    """
    Another axis moves by random sines, unrecorded, and loads the sensor sideways.

    y = F_e + gain (sum of 6 sines between 0.1 and 2 Hz, random in phase).
    Siciliano and Khatib, Springer Handbook of Robotics, 2016 (multi-axis force sensors).
    """

    stages = ('press', 'specimen', 'drive')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        seed = float(rng.integers(1_000_000))
        return lambda s: {'gain': 0.2 * s * m.force, 'seed': seed}

    def sense(self, signals: Signals) -> Array:
        rng = np.random.default_rng(int(self.values.seed))
        other = sum(np.sin(2.0 * pi * f * signals.t + phase) for f, phase in
                    zip(rng.uniform(0.1, 2.0, 6), rng.uniform(0.0, 2.0 * pi, 6)))
        return np.asarray(signals.force + self.values.gain / 3.0**0.5 * other)


class WarmingSensor(SensorLaw):
    """
    A gain that approaches another value exponentially.

    y = F_e (1 + change (1 - exp(-t / tau))).
    Fraden, Handbook of Modern Sensors, 2016 (thermal sensitivity shift). On a specimen it is the
    same as a stiffness that drifts.
    """

    stages = ('press', 'drive')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        tau = m.duration * float(rng.uniform(0.1, 0.5))
        change = float(rng.choice([-0.6, 0.6]))
        return lambda s: {'change': s * change, 'tau': tau}

    def sense(self, signals: Signals) -> Array:
        p = self.values
        return np.asarray(signals.force * (1.0 + p.change * (1.0 - np.exp(-signals.t / p.tau))))


class ResonantMount(SensorLaw):
    """
    A lightly damped resonance of sensor and tool between 20 and 60 Hz.

    y = r + mass a, r'' + 2 zeta omega r' + omega^2 r = omega^2 (F_e - mass a): the mass on the
    sensor is known and taken off, its ringing is not.
    Eppinger and Seering, IEEE Control Systems Magazine 7(2), 1987 (sensor dynamics).
    """

    stages = ('press', 'drive')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        frequency, zeta = float(rng.uniform(20.0, 60.0)), float(rng.uniform(0.01, 0.06))
        mass = m.force * m.depth / m.speed**2
        return lambda s: {'mass': s * mass, 'frequency': frequency, 'zeta': zeta}

    def sense(self, signals: Signals) -> Array:
        p, omega = self.values, 2.0 * pi * self.values.frequency
        load = signals.force - p.mass * signals.a
        return low_passed(load, signals.dt, omega, p.zeta, load[0]) + p.mass * signals.a


class SoftTool(SensorLaw):
    """
    The sensor feels a mass that follows the tool with a lag.

    y = F_e - mass (acceleration low-passed at `corner`).
    Garcia, Robertsson, Ortega and Johansson, IEEE Trans. Robotics 24(2), 2008 (tool inertia).
    """

    families = ('inertia',)
    stages = ('press', 'specimen')

    @classmethod
    def draw(cls, m: Magnitudes, rng: Generator) -> Strength:
        corner = log_uniform(rng, 15.0, 60.0)
        mass = 0.3 * m.force * m.depth / m.speed**2
        return lambda s: {'mass': s * mass, 'corner': corner}

    def sense(self, signals: Signals) -> Array:
        felt = low_passed(signals.a, signals.dt, 2.0 * pi * self.values.corner, 0.7)
        return signals.force - self.values.mass * felt


class FlexibleMount(YieldingLaw, SensorLaw):
    """
    Sensor and tip sit on a spring; the position is measured before it.

    m y'' = k (x - y) + c (x' - y') + F_e(y, y'), F_e measured at the tip.
    Eppinger and Seering, IEEE Control Systems Magazine 7(2), 1987 (tool compliance).
    """

    families = ('timing', 'relaxation', 'inertia')
    stages = ('press',)
    shares = 0.02, 0.1
