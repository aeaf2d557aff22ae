# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Randomised worlds: wall, robot, sensors and experiment, without a missing effect."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.random import Generator

from .experiments import draw_experiment, Stage
from ...physics.random_strength import log_uniform
from ...plant.plant_parameters import RobotParameters, WallParameters
from ...reference.experiment import Experiment


@dataclass(frozen=True)
class SensorModel:
    """Sampling, noise, quantisation, filtering and timing errors of the recording."""

    rate: float = 500.0  # sample rate of all three signals [Hz]
    # force_noise, position_noise: standard deviations [N], [m]
    force_noise: float = 0.3
    position_noise: float = 3e-6
    distribution: str = 'normal'  # force noise: 'normal' or 'uniform'
    # force_step, position_step: quantisation steps [N], [m]; 0: none
    force_step: float = 0.0
    position_step: float = 1e-6
    velocity_noise: float | None = 3e-4  # standard deviation [m/s]; None: velocity is not recorded
    # cut-off of the force sensor's anti-alias filter [Hz]; the driver subtracts the filter's delay
    # from the stamps. 0: no filter.
    low_pass: float = 0.0
    jitter: float = 0.0  # standard deviation of the stamps [s]
    # delay of the position samples after the force samples, in sample periods
    joint_phase: float = 0.0
    dropped: float = 0.0  # fraction of dropped samples

    @property
    def force_std(self) -> float:
        """Return the standard deviation of force noise and rounding [N]."""
        return sqrt(self.force_noise**2 + self.force_step**2 / 12.0)

    @property
    def position_std(self) -> float:
        """Return the standard deviation of position noise and rounding [m]."""
        return sqrt(self.position_noise**2 + self.position_step**2 / 12.0)


@dataclass(frozen=True)
class RandomWorld:
    """A world in which the spring-damper model is complete."""

    wall: WallParameters  # True K_e, B_e and x_e
    robot: RobotParameters  # True M_t, B_t and K_t
    sensors: SensorModel  # sensors of the recording
    experiment: Experiment  # commanded motion
    depth: float  # planned maximum penetration [m]


def draw_world(rng: Generator) -> RandomWorld:
    """Draw wall, robot, sensors and experiment."""
    wall = WallParameters(
        stiffness=_round(log_uniform(rng, 1200.0, 16000.0)),
        damping=_round(log_uniform(rng, 20.0, 280.0)),
        location=0.0 if _coin(rng, 0.5) else round(float(rng.uniform(-0.03, 0.03)), 6),
    )
    robot = _draw_robot(rng)
    depth = float(np.clip(log_uniform(rng, 45.0, 160.0) / wall.stiffness, 0.006, 0.06))
    stage = Stage(wall.location, wall.location - float(rng.uniform(0.01, 0.025)),
                  depth * (1.0 + wall.stiffness / robot.stiffness))
    return RandomWorld(wall, robot, _draw_sensors(rng), draw_experiment(stage, rng), depth)


def _draw_robot(rng: Generator) -> RobotParameters:
    mass = log_uniform(rng, 9.0, 50.0)
    stiffness = log_uniform(rng, 1200.0, 16000.0)
    damping = 2.0 * rng.uniform(0.8, 1.2) * sqrt(mass * stiffness)
    return RobotParameters(mass=_round(mass), damping=_round(damping), stiffness=_round(stiffness))


def _draw_sensors(rng: Generator) -> SensorModel:
    noise = log_uniform(rng, 0.16, 0.8)
    return SensorModel(
        rate=float(rng.choice([250.0, 500.0, 1000.0], p=[0.07, 0.86, 0.07])),
        force_noise=_round(noise),
        position_noise=_round(log_uniform(rng, 1.5e-6, 6e-6)),
        distribution='uniform' if _coin(rng, 0.2) else 'normal',
        force_step=_round(rng.uniform(0.1, 0.6) * noise) if _coin(rng, 0.4) else 0.0,
        position_step=float(rng.choice([0.0, 1e-6, 2e-6, 5e-6])),
        velocity_noise=None if _coin(rng, 0.25) else _round(log_uniform(rng, 1e-4, 1e-3)),
        low_pass=_round(rng.uniform(100.0, 200.0)) if _coin(rng, 0.25) else 0.0,
        jitter=_round(rng.uniform(1e-5, 5e-5)) if _coin(rng, 0.5) else 0.0,
        joint_phase=round(float(rng.uniform(0.0, 1.0)), 3) if _coin(rng, 0.25) else 0.0,
        dropped=0.003 if _coin(rng, 0.2) else 0.0,
    )


def draw_nominal_wall(wall: WallParameters, rng: Generator, exact: float) -> WallParameters:
    """Draw the wall of the nominal model: K_e off by up to 25 %, B_e by up to 60 %."""
    if _coin(rng, exact):
        return wall
    error_K, error_B = rng.uniform(-0.25, 0.25), rng.uniform(-0.6, 0.6)
    return WallParameters(
        stiffness=_round(wall.stiffness * (1.0 + error_K)),
        damping=_round(wall.damping * (1.0 + error_B)), location=wall.location)


def _coin(rng: Generator, probability: float) -> bool:
    return bool(rng.uniform() < probability)


def _round(value: float) -> float:
    return float(f'{value:.6g}')
