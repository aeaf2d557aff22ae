# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Which parameters of an effect are plausible, from the orders of magnitude of its world."""

from math import exp, log, log10, nan
from typing import Callable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.random import Generator

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


def between(low: float, high: float, share: float) -> float:
    """Return the number at a share of the way, on a logarithmic scale where both are positive."""
    if low > 0.0 and high > 0.0:
        return low * (high / low) ** share
    return low + share * (high - low)


_SHARE = 0.1  # of the force, which an effect may add where there is no spring or no damper
_SLOWEST_S = 0.1  # delay
_FEWEST, _MOST = 3, 9  # values of a spread

Tone = tuple[float, complex]
"""Frequency [Hz], or [1/m] along the way, and complex amplitude."""


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
    # frequency [1/m] and complex amplitude [N] of the largest peaks in the spectrum of the contact
    # residual over d
    waves: tuple[Tone, ...] = ()

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
        """Return 3 to 9 time constants [s], of a sample to that of the recording."""
        least = max(2.0 * self.sample_period, 1e-5 * self.duration)
        return _spread(min(least, 0.1 * self.duration), self.duration, 1.5)

    def delays(self) -> list[float]:
        """Return 3 to 9 delays [s] from half a sample to a fifth of the pace, at most 0.1 s."""
        # Sensors and buses are no slower, however slow the motion; a start may be three samples.
        most = max(min(0.2 * self.pace, _SLOWEST_S), 3.0 * self.sample_period)
        return _spread(max(0.5 * self.sample_period, 1e-3 * most), most, 2.5)


def _spread(least: float, most: float, per_decade: float) -> list[float]:
    count = round(per_decade * log10(most / least)) + 1
    spread = np.geomspace(least, most, min(max(count, _FEWEST), _MOST))
    return [float(value) for value in spread]


class Prior(NamedTuple):
    """Plausible parameters of an effect."""

    # of all parameters, where a search begins: several where the cost has several local minima
    starts: Sequence[tuple[float, ...]]
    largest: float = nan  # of the first parameter; NaN: a multiple of that of a start
    either_sign: bool = False  # whether the first parameter may have either sign
