# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Worlds of chance: wall, robot, sensors and experiment; what is missing comes after."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.random import Generator

from .experiments import draw_experiment, Stage
from ..plant.plant_parameters import RobotParameters, WallParameters
from ..reference.experiment import Experiment


@dataclass(frozen=True)
class Sensing:
    """
    What stands between the world and the recording.

    Attributes
    ----------
    rate : float
        Of all three signals [Hz].
    force_noise, position_noise : float
        Standard deviations [N], [m].
    distribution : str
        Of the force noise: 'normal' or 'uniform'.
    force_step, position_step : float
        Of the quantisation [N], [m]; 0: none.
    velocity_noise : float or None
        Standard deviation [m/s]; None: no velocity is sent.
    low_pass : float
        Cut-off of the force sensor's anti-alias filter [Hz], the delay of which the driver takes
        off its stamps; 0: none.
    jitter : float
        Standard deviation of the stamps [s].
    joint_phase : float
        How much later than the force the position is sampled, in sample periods.
    dropped : float
        Share of samples that are lost.

    """

    rate: float = 500.0
    force_noise: float = 0.3
    position_noise: float = 3e-6
    distribution: str = 'normal'
    force_step: float = 0.0
    position_step: float = 1e-6
    velocity_noise: float | None = 3e-4
    low_pass: float = 0.0
    jitter: float = 0.0
    joint_phase: float = 0.0
    dropped: float = 0.0

    @property
    def force_std(self) -> float:
        """Of noise and rounding [N]."""
        return sqrt(self.force_noise**2 + self.force_step**2 / 12.0)

    @property
    def position_std(self) -> float:
        """Of noise and rounding [m]."""
        return sqrt(self.position_noise**2 + self.position_step**2 / 12.0)


@dataclass(frozen=True)
class Setup:
    """
    A world in which nothing is missing from the model but the right numbers.

    Attributes
    ----------
    wall : WallParameters
        True K_e, B_e and x_e.
    robot : RobotParameters
        True M_t, B_t and K_t.
    sensing : Sensing
        The sensors.
    experiment : Experiment
        What is asked of the robot.
    depth : float
        Greatest penetration that is aimed at [m].

    """

    wall: WallParameters
    robot: RobotParameters
    sensing: Sensing
    experiment: Experiment
    depth: float


def draw_setup(rng: Generator) -> Setup:
    """
    Draw everything but what will be missing.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of chance.

    Returns
    -------
    setup : Setup
        Its numbers rounded as a model file has them.

    """
    wall = WallParameters(
        stiffness=_digits(_log_uniform(rng, 1200.0, 16000.0)),
        damping=_digits(_log_uniform(rng, 20.0, 280.0)),
        location=0.0 if chance(rng, 0.5) else round(float(rng.uniform(-0.03, 0.03)), 6),
    )
    robot = _draw_robot(rng)
    depth = float(np.clip(_log_uniform(rng, 45.0, 160.0) / wall.stiffness, 0.006, 0.06))
    stage = Stage(wall.location, wall.location - float(rng.uniform(0.01, 0.025)),
                  depth * (1.0 + wall.stiffness / robot.stiffness))
    return Setup(wall, robot, _draw_sensing(rng), draw_experiment(stage, rng), depth)


def _draw_robot(rng: Generator) -> RobotParameters:
    mass = _log_uniform(rng, 9.0, 50.0)
    stiffness = _log_uniform(rng, 1200.0, 16000.0)
    damping = 2.0 * rng.uniform(0.8, 1.2) * sqrt(mass * stiffness)
    return RobotParameters(
        mass=_digits(mass), damping=_digits(damping), stiffness=_digits(stiffness))


def _draw_sensing(rng: Generator) -> Sensing:
    noise = _log_uniform(rng, 0.16, 0.8)
    return Sensing(
        rate=float(rng.choice([250.0, 500.0, 1000.0], p=[0.07, 0.86, 0.07])),
        force_noise=_digits(noise),
        position_noise=_digits(_log_uniform(rng, 1.5e-6, 6e-6)),
        distribution='uniform' if chance(rng, 0.2) else 'normal',
        force_step=_digits(rng.uniform(0.1, 0.6) * noise) if chance(rng, 0.4) else 0.0,
        position_step=float(rng.choice([0.0, 1e-6, 2e-6, 5e-6])),
        velocity_noise=None if chance(rng, 0.25) else _digits(_log_uniform(rng, 1e-4, 1e-3)),
        low_pass=_digits(rng.uniform(100.0, 200.0)) if chance(rng, 0.25) else 0.0,
        jitter=_digits(rng.uniform(1e-5, 5e-5)) if chance(rng, 0.5) else 0.0,
        joint_phase=round(float(rng.uniform(0.0, 1.0)), 3) if chance(rng, 0.25) else 0.0,
        dropped=0.003 if chance(rng, 0.2) else 0.0,
    )


def draw_nominal(wall: WallParameters, rng: Generator, exactly: float) -> WallParameters:
    """
    Draw what the model file says of the wall: K_e off by up to 25 %, B_e by up to 60 %.

    Parameters
    ----------
    wall : WallParameters
        What a spring-damper in the wall's place would have.
    rng : numpy.random.Generator
        Source of chance.
    exactly : float
        Chance that the model file is right.

    Returns
    -------
    nominal : WallParameters
        For the model file.

    """
    if chance(rng, exactly):
        return wall
    off_K, off_B = rng.uniform(-0.25, 0.25), rng.uniform(-0.6, 0.6)
    return WallParameters(
        stiffness=_digits(wall.stiffness * (1.0 + off_K)),
        damping=_digits(wall.damping * (1.0 + off_B)), location=wall.location)


def chance(rng: Generator, probability: float) -> bool:
    """
    Throw a loaded coin.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of chance.
    probability : float
        Of True.

    Returns
    -------
    outcome : bool
        True or False.

    """
    return bool(rng.uniform() < probability)


def _log_uniform(rng: Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _digits(value: float) -> float:
    return float(f'{value:.6g}')
