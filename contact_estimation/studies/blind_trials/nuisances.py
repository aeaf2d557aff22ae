# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Small nuisances of a real rig, each about one percent of the force range."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Nuisances:
    """Small departures from the ideal world."""

    bias: float  # residue of gravity compensation on the force [N]
    cable: float  # stiffness of the cable that pulls at the sensor [N/m]
    # hum, hum_frequency: amplitude [N] and frequency [Hz] of mains hum on the force
    hum: float
    hum_frequency: float
    # colour, colour_corner: standard deviation [N] and corner [Hz] of coloured force noise
    colour: float
    colour_corner: float
    cubic: float  # relative change of the elastic force at the largest depth
    robot_friction: float  # friction of the joint [N]


def draw_nuisances(force: float, travel: float, noise: float, rng: Generator) -> Nuisances:
    """
    Draw the nuisances of a rig.

    force, travel: range of force [N] and position [m]
    noise: standard deviation of the white force noise [N]
    """
    drawn = (
        force * rng.uniform(-0.006, 0.006), force / travel * rng.uniform(-0.008, 0.008),
        force * rng.uniform(0.0, 0.003), rng.choice([50.0, 60.0]) * rng.uniform(0.998, 1.002),
        noise * rng.uniform(0.2, 0.7), np.exp(rng.uniform(np.log(0.3), np.log(10.0))),
        rng.uniform(-0.01, 0.01), force * rng.uniform(0.001, 0.006),
    )
    return Nuisances(*(float(f'{value:.4g}') for value in drawn))


def disturbed(
    t: Array, x: Array, force: Array, nuisances: Nuisances, rng: Generator
) -> Array:
    """
    Add bias, cable, hum and coloured noise to a force.

    t, x, force (N,): time, evenly spaced [s], position [m] and measured force [N]
    Returns force (N,): force before filter, white noise and rounding [N]
    """
    n, rate = nuisances, 1.0 / float(t[1] - t[0])
    fade = float(np.exp(-2.0 * pi * min(n.colour_corner, 0.2 * rate) / rate))
    white = rng.standard_normal(len(t)) * n.colour * (1.0 - fade**2) ** 0.5
    hum = n.hum * np.sin(2.0 * pi * n.hum_frequency * t)
    slow = rate > 4.0 * n.hum_frequency  # else the sensor averages over the mains period
    return np.asarray(force + n.bias - n.cable * (x - x[0]) + (hum if slow else 0.0)
                      + lfilter([1.0], [1.0, -fade], white))
