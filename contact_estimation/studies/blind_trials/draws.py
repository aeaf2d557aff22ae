# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Random worlds: ideal ones; robots that press, attached specimens and drives of laboratories."""

from dataclasses import replace
from math import pi, sqrt
from typing import Callable, Mapping

import numpy as np
from numpy.random import Generator

from .experiments import draw_motion, draw_to_and_fro, draw_touches, draw_waits, Stage
from .world import Nuisances, SensorModel, World
from ...physics.prior import log_uniform
from ...plant.plant_parameters import RobotParameters, WallParameters
from ...reference.experiment import Experiment

_FASTEST = 0.02  # highest frequency of a specimen's motion, of the sample rate


def digits(value: float, count: int = 6) -> float:
    """Round to significant digits."""
    return float(f'{value:.{count}g}')


def coin(rng: Generator, probability: float) -> bool:
    """Draw whether something with a probability is so."""
    return bool(rng.uniform() < probability)


# -- ideal ----------------------------------------------------------------------------------


def draw_ideal(rng: Generator) -> World:
    """Draw wall, robot, sensors and experiment."""
    wall = WallParameters(
        stiffness=digits(log_uniform(rng, 1200.0, 16000.0)),
        damping=digits(log_uniform(rng, 20.0, 280.0)),
        location=0.0 if coin(rng, 0.5) else round(float(rng.uniform(-0.03, 0.03)), 6))
    mass, stiffness = log_uniform(rng, 9.0, 50.0), log_uniform(rng, 1200.0, 16000.0)
    damping = 2.0 * rng.uniform(0.8, 1.2) * sqrt(mass * stiffness)
    robot = RobotParameters(
        mass=digits(mass), damping=digits(damping), stiffness=digits(stiffness))
    depth = float(np.clip(log_uniform(rng, 45.0, 160.0) / wall.stiffness, 0.006, 0.06))
    stage = Stage(wall.location, wall.location - float(rng.uniform(0.01, 0.025)),
                  depth * (1.0 + wall.stiffness / robot.stiffness))
    sensors, experiment = _ideal_sensors(rng), draw_touches(stage, rng)
    return World(experiment.name, wall, robot, sensors, experiment, depth)


def _ideal_sensors(rng: Generator) -> SensorModel:
    noise = log_uniform(rng, 0.16, 0.8)
    return SensorModel(
        rate=float(rng.choice([250.0, 500.0, 1000.0], p=[0.07, 0.86, 0.07])),
        force_noise=digits(noise), position_noise=digits(log_uniform(rng, 1.5e-6, 6e-6)),
        distribution='uniform' if coin(rng, 0.2) else 'normal',
        force_step=digits(rng.uniform(0.1, 0.6) * noise) if coin(rng, 0.4) else 0.0,
        position_step=float(rng.choice([0.0, 1e-6, 2e-6, 5e-6])),
        velocity_noise=None if coin(rng, 0.25) else digits(log_uniform(rng, 1e-4, 1e-3)),
        low_pass=digits(rng.uniform(100.0, 200.0)) if coin(rng, 0.25) else 0.0,
        jitter=digits(rng.uniform(1e-5, 5e-5)) if coin(rng, 0.5) else 0.0,
        joint_phase=round(float(rng.uniform(0.0, 1.0)), 3) if coin(rng, 0.25) else 0.0,
        dropped=0.003 if coin(rng, 0.2) else 0.0)


def draw_nominal(wall: WallParameters, rng: Generator, exact: float, mass_error: float = 0.0
                 ) -> WallParameters:
    """Draw the wall of the nominal model: K_e off by up to 25 %, B_e by up to 60 %."""
    if coin(rng, exact):
        return wall
    error_K, error_B = rng.uniform(-0.25, 0.25), rng.uniform(-0.6, 0.6)
    error_M = rng.uniform(-mass_error, mass_error) if mass_error else 0.0
    return replace(wall, stiffness=digits(wall.stiffness * (1.0 + error_K)),
                   damping=digits(wall.damping * (1.0 + error_B)),
                   inertia=digits(wall.inertia * (1.0 + error_M)))


# -- rigs -----------------------------------------------------------------------------------


def _nuisances(force: float, travel: float, noise: float, rng: Generator) -> Nuisances:
    """Draw nuisances by the ranges of force [N] and travel [m] and the std of the noise [N]."""
    drawn = (
        force * rng.uniform(-0.006, 0.006), force / travel * rng.uniform(-0.008, 0.008),
        force * rng.uniform(0.0, 0.003), rng.choice([50.0, 60.0]) * rng.uniform(0.998, 1.002),
        noise * rng.uniform(0.2, 0.7), log_uniform(rng, 0.3, 10.0),
        rng.uniform(-0.01, 0.01), force * rng.uniform(0.001, 0.006))
    return Nuisances(*(digits(value, 4) for value in drawn))


def _sensors(
    rate: float, force: float, travel: float, speed: float, rng: Generator
) -> SensorModel:
    """Draw the sensors of a rig: noise and rounding in proportion to the ranges."""
    noise = force * log_uniform(rng, 0.002, 0.006)
    return SensorModel(
        rate=rate, force_noise=digits(noise), force_step=digits(noise * rng.uniform(0.1, 0.5)),
        position_noise=digits(travel * log_uniform(rng, 3e-5, 2e-4)),
        position_step=digits(travel * log_uniform(rng, 3e-5, 2e-4), 1),
        velocity_noise=None if coin(rng, 0.5) else digits(speed * rng.uniform(2e-3, 1e-2)),
        low_pass=digits(rng.uniform(100.0, 300.0), 3) if rate >= 1000.0 else 0.0,
        jitter=digits(min(1e-4, 0.05 / rate), 3), dropped=0.002)


def _press(rng: Generator) -> World:
    """Draw a robot that touches a wall several times."""
    while True:
        world = draw_ideal(rng)
        if world.stage in ('rich', 'cycles'):
            break
    force = world.wall.stiffness * world.depth
    rate = float(rng.choice([250.0, 500.0, 1000.0], p=[0.2, 0.7, 0.1]))
    drawn = _sensors(rate, force, world.depth, 0.05, rng)
    sensors = replace(
        drawn, position_noise=world.sensors.position_noise, position_step=float(
            rng.choice([1e-6, 2e-6, 5e-6])), velocity_noise=world.sensors.velocity_noise,
        low_pass=digits(rng.uniform(100.0, 0.45 * min(rate, 660.0)), 3))
    return replace(world, stage='press', sensors=sensors,
                   nuisances=_nuisances(force, world.depth, sensors.force_noise, rng))


def _specimen(rng: Generator) -> World:
    """Draw a specimen in a testing machine, moved for seconds."""
    rate = float(rng.choice([100.0, 200.0, 250.0, 500.0, 1000.0]))
    fastest = min(8.0, _FASTEST * rate)
    travel, force = log_uniform(rng, 5e-4, 0.02), log_uniform(rng, 3.0, 600.0)
    experiment = draw_motion(travel, fastest, rng)
    return _attached(experiment, travel, force, fastest, rate, rng)


def _slow(rng: Generator) -> World:
    """Draw a relaxation test of minutes, sampled slowly."""
    rate = float(rng.choice([1.0, 2.0, 5.0, 10.0]))
    travel, force = log_uniform(rng, 5e-4, 0.02), log_uniform(rng, 0.5, 300.0)
    ramp = max(4.0 / rate, float(rng.uniform(1.0, 4.0)))
    return _attached(draw_waits(travel, ramp, rng), travel, force, 1.0 / ramp, rate, rng)


def _attached(
    experiment: Experiment, travel: float, force: float, fastest: float, rate: float,
    rng: Generator,
) -> World:
    """Put a specimen of a given force range under a motion."""
    stiffness = force / travel
    damping = stiffness / (2.0 * pi * fastest) * log_uniform(rng, 0.03, 0.3)
    wall = WallParameters(stiffness=digits(stiffness), damping=digits(damping), unilateral=False)
    sensors = _sensors(rate, force, travel, 2.0 * fastest * travel, rng)
    return World(experiment.name, wall, None, sensors, experiment, travel,
                 _nuisances(force, travel, sensors.force_noise, rng))


def _drive(rng: Generator) -> World:
    """Draw a mass on a guide, moved to and fro."""
    rate = float(rng.choice([200.0, 500.0, 1000.0]))
    travel, mass = log_uniform(rng, 0.02, 0.2), log_uniform(rng, 1.0, 90.0)
    frequency = float(rng.uniform(0.4, 1.5))
    experiment = draw_to_and_fro(travel, frequency, rng)
    greatest = max(abs(experiment.desired(0.01 * k).acceleration)
                   for k in range(int(100.0 * experiment.duration)))
    force, speed = mass * greatest, 2.0 * frequency * travel
    wall = WallParameters(
        stiffness=0.0, damping=digits(force / speed * log_uniform(rng, 0.1, 0.5)),
        inertia=digits(mass), unilateral=False)
    sensors = replace(_sensors(rate, force, travel, speed, rng),
                      position_noise=digits(travel * log_uniform(rng, 3e-6, 2e-5)),
                      position_step=digits(travel * log_uniform(rng, 3e-6, 2e-5), 1))
    return World('drive', wall, None, sensors, experiment, travel,
                 _nuisances(force, travel, sensors.force_noise, rng))


STAGES: Mapping[str, Callable[[Generator], World]] = {
    'press': _press, 'specimen': _specimen, 'slow': _slow, 'drive': _drive,
}
"""Draws of rigs by kind of experiment."""
