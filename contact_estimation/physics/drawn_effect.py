# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Starts and random strengths of an effect, from the orders of magnitude of its world."""

from __future__ import annotations

from abc import ABC
from dataclasses import fields
from math import exp, log, log10
from typing import Callable, ClassVar, Mapping, NamedTuple

import numpy as np
from numpy.random import Generator

from ..parameters.specification import ParameterGroup


Values = Mapping[str, float]
"""Parameters of an effect by name."""

Strength = Callable[[float], Values]
"""From a magnitude, 0 (absent) to 1 (largest plausible), to the parameters of an effect."""


def log_uniform(rng: Generator, low: float, high: float) -> float:
    """Draw a positive number whose logarithm is uniformly distributed."""
    return exp(rng.uniform(log(low), log(high)))


def random_sign(rng: Generator) -> float:
    """Draw -1 or 1 with equal probability."""
    return float(rng.choice([-1.0, 1.0]))


_SHARE = 0.1  # of the force, which an effect may add where there is no spring or no damper
_SLOWEST_S = 0.1  # delay
_FEWEST, _MOST = 3, 9  # values of a spread

Tone = tuple[float, complex]
"""Frequency [Hz] and complex amplitude."""


class Scales(NamedTuple):
    """Orders of magnitude in a recording."""

    # depth, speed, force, control: largest penetration [m], penetration rate [m/s], contact force
    # [N] and control force [N]
    depth: float
    speed: float
    force: float
    control: float
    greatest_pull: float  # largest positive F_e [N]
    duration: float  # length of the recording [s]
    # stiffness, damping, mass: K_e [N/m] and B_e [N s/m] fitted without effects, M_t [kg]
    stiffness: float
    damping: float
    mass: float
    # frequency [Hz] and complex amplitude [N] of the largest peaks in the spectrum of the contact
    # residual
    spectrum: tuple[Tone, ...] = ()
    sample_period: float = 0.0  # shortest time between samples [s]; 0 where unknown
    # the two tones that together explain most of that residual; empty where unknown
    beat: tuple[Tone, ...] = ()
    driven: bool = False  # whether a measured force moves the wall, without a robot

    @property
    def pace(self) -> float:
        """Time in which the motion covers the depth [s]."""
        return self.depth / self.speed

    @property
    def spring(self) -> float:
        """Stiffness of a wall that contributes to the force [N/m]; K_e if there is a spring."""
        return max(self.stiffness, _SHARE * self.force / self.depth)

    @property
    def damper(self) -> float:
        """Damping of a wall that contributes to the force [N s/m]; B_e if there is a damper."""
        return max(self.damping, _SHARE * self.force / self.speed)

    @property
    def moved_mass(self) -> float:
        """Mass that the force accelerates at the pace of the motion [kg]."""
        return self.force * self.pace / self.speed

    def peaks(self) -> tuple[Tone, ...]:
        """Return the peaks of the residual spectrum, or one guess where none is known."""
        return self.spectrum or ((0.2 / self.pace, complex(0.0, -0.02 * self.force)),)

    def time_constants(self) -> list[float]:
        """
        Return time constants from that of a sample to that of the recording.

        Returns time_constants: 3 to 9 of them [s], about 1.5 a decade, increasing
        """
        least = max(2.0 * self.sample_period, 1e-5 * self.duration)
        return _spread(min(least, 0.1 * self.duration), self.duration, 1.5)

    def delays(self) -> list[float]:
        """
        Return delays from half a sample to a fifth of the pace of the motion, at most 0.1 s.

        Sensors and buses are no slower, however slow the motion; a start may be three samples.

        Returns delays: 3 to 9 of them [s], about 2.5 a decade, increasing
        """
        most = max(min(0.2 * self.pace, _SLOWEST_S), 3.0 * self.sample_period)
        return _spread(max(0.5 * self.sample_period, 1e-3 * most), most, 2.5)


def _spread(least: float, most: float, per_decade: float) -> list[float]:
    count = round(per_decade * log10(most / least)) + 1
    spread = np.geomspace(least, most, min(max(count, _FEWEST), _MOST))
    return [float(value) for value in spread]


_LARGEST_OVER_START = 30.0  # of an effect that does not say what is plausible


class DrawnEffect(ABC):
    """Starts and draws of the parameters of an effect."""

    # all fields are floats; NaN, the default, switches the effect off
    Parameters: ClassVar[type[ParameterGroup]]
    # values of parameters at which the effect vanishes, where not 0
    neutral: ClassVar[Mapping[str, float]] = {}
    either_sign: ClassVar[bool] = False  # whether the first parameter is drawn with either sign

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """
        Return the points from which a search for the parameters starts.

        Returns starts: values of all parameters; several where the cost has several local minima
        """
        raise NotImplementedError

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """
        Return the largest plausible magnitude of the first parameter.

        scales: orders of magnitude in the world that the effect acts in
        """
        neutral = cls.neutral.get(fields(cls.Parameters)[0].name, 0.0)
        return neutral + _LARGEST_OVER_START * (cls.starts(scales)[0][0] - neutral)

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """
        Draw everything but the magnitude at random.

        By default the first parameter is proportional to the magnitude and the others keep the
        values of the first start.

        scales: orders of magnitude in the world that the effect acts in
        Returns strength: from a magnitude, 0 (absent) to 1 (largest plausible), to parameters by
        name
        """
        names = [field.name for field in fields(cls.Parameters)]
        rest = dict(zip(names[1:], cls.starts(scales)[0][1:]))
        neutral = cls.neutral.get(names[0], 0.0)
        most = (cls.largest(scales) - neutral) * (random_sign(rng) if cls.either_sign else 1.0)
        return lambda s: {names[0]: neutral + s * most, **rest}

    @classmethod
    def equivalent_damping(cls, values: Values, damping: float, depth: float) -> float:
        """
        Return B_e of the spring-damper that a model without the effect would contain.

        damping: B_e of the wall beside the effect [N s/m]
        depth: largest penetration [m]
        Returns damping: B_e [N s/m]
        """
        return damping
