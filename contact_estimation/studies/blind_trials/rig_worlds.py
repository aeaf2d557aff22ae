# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Randomised rigs: robots that press, attached specimens, slow relaxation tests and drives."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import Callable, Mapping

from numpy.random import Generator

from .experiments import Builder, Stage
from .foreign_law import log_uniform
from .rig import draw_nuisances, Rig
from .worlds import draw_world, SensorModel
from ...plant.plant_parameters import WallParameters
from ...reference.experiment import Experiment, Multisine, Sine

_FASTEST = 0.02  # highest frequency of a specimen's motion, of the sample rate


def draw_rig(stage: str, rng: Generator) -> Rig:
    """Draw a rig."""
    return STAGES[stage](rng)


def _digits(value: float, count: int = 6) -> float:
    return float(f'{value:.{count}g}')


def _sensors(
    rate: float, force: float, travel: float, speed: float, rng: Generator
) -> SensorModel:
    """Draw the sensors of a rig: noise and rounding in proportion to the ranges."""
    noise = force * log_uniform(rng, 0.002, 0.006)
    return SensorModel(
        rate=rate, force_noise=_digits(noise), force_step=_digits(noise * rng.uniform(0.1, 0.5)),
        position_noise=_digits(travel * log_uniform(rng, 3e-5, 2e-4)),
        position_step=_digits(travel * log_uniform(rng, 3e-5, 2e-4), 1),
        velocity_noise=None if rng.uniform() < 0.5 else _digits(speed * rng.uniform(2e-3, 1e-2)),
        low_pass=_digits(rng.uniform(100.0, 300.0), 3) if rate >= 1000.0 else 0.0,
        jitter=_digits(min(1e-4, 0.05 / rate), 3), dropped=0.002,
    )


# -- robot ----------------------------------------------------------------------------------


def _draw_press(rng: Generator) -> Rig:
    """Draw a robot that touches a wall several times."""
    while True:
        world = draw_world(rng)
        if world.experiment.name in ('rich', 'cycles'):
            break
    force = world.wall.stiffness * world.depth
    rate = float(rng.choice([250.0, 500.0, 1000.0], p=[0.2, 0.7, 0.1]))
    drawn = _sensors(rate, force, world.depth, 0.05, rng)
    sensors = replace(
        drawn, position_noise=world.sensors.position_noise, position_step=float(
            rng.choice([1e-6, 2e-6, 5e-6])), velocity_noise=world.sensors.velocity_noise,
        low_pass=_digits(rng.uniform(100.0, 0.45 * min(rate, 660.0)), 3))
    nuisances = draw_nuisances(force, world.depth, sensors.force_noise, rng)
    return Rig('press', world.wall, world.robot, sensors, world.experiment, nuisances, world.depth)


# -- attached -------------------------------------------------------------------------------


def _draw_specimen(rng: Generator) -> Rig:
    """Draw a specimen in a testing machine, moved for seconds."""
    rate = float(rng.choice([100.0, 200.0, 250.0, 500.0, 1000.0]))
    fastest = min(8.0, _FASTEST * rate)
    travel, force = log_uniform(rng, 5e-4, 0.02), log_uniform(rng, 3.0, 600.0)
    builder = Builder(Stage(0.0, 0.0, travel))
    _MOTIONS[int(rng.integers(len(_MOTIONS)))](builder, travel, fastest, rng)
    return _attached('specimen', builder.experiment('specimen'), travel, force, fastest, rate, rng)


def _cycles(builder: Builder, travel: float, fastest: float, rng: Generator) -> None:
    """Add cycles of growing and shrinking amplitude about a mean depth."""
    builder.wait(0.5)
    builder.go(0.5 * travel, 1.0)
    frequency = fastest * log_uniform(rng, 0.15, 0.6)
    for level in rng.permutation([0.15, 0.3, 0.45]).tolist():
        cycles = int(rng.integers(3, 7))
        builder.hold(max(1.5, cycles / frequency), Sine(level * travel, 2.0 * pi * frequency))
    builder.go(0.0, 1.0)
    builder.wait(0.5)


def _random(builder: Builder, travel: float, fastest: float, rng: Generator) -> None:
    """Add multisines about two mean depths."""
    for mean in rng.permutation([0.4, 0.65]).tolist():
        builder.wait(0.5)
        builder.go(mean * travel, float(rng.uniform(0.8, 2.0)))
        count = int(rng.integers(3, 8))
        omegas = (2.0 * pi * fastest * rng.uniform(0.05, 1.0, count)).tolist()
        builder.hold(float(rng.uniform(3.0, 7.0)), Multisine(0.34 * travel, omegas))
        builder.go(0.0, float(rng.uniform(0.8, 2.0)))
    builder.wait(0.5)


def _steps(builder: Builder, travel: float, fastest: float, rng: Generator) -> None:
    """Add ramps of different speed with holds between them."""
    builder.wait(0.5)
    for level in rng.permutation([0.3, 0.6, 1.0, 0.45, 0.0, 0.8]).tolist():
        builder.go(level * travel, float(rng.choice([0.4, 0.8, 1.5])))
        builder.wait(float(rng.uniform(0.8, 2.0)))
    builder.go(0.0, 1.0)
    builder.wait(0.5)


_MOTIONS = (_cycles, _random, _steps)


def _draw_slow(rng: Generator) -> Rig:
    """Draw a relaxation test of minutes, sampled slowly."""
    rate = float(rng.choice([1.0, 2.0, 5.0, 10.0]))
    travel, force = log_uniform(rng, 5e-4, 0.02), log_uniform(rng, 0.5, 300.0)
    builder, ramp = Builder(Stage(0.0, 0.0, travel)), max(4.0 / rate, float(rng.uniform(1.0, 4.0)))
    builder.wait(5.0)
    levels = rng.permutation([0.35, 0.7, 1.0, 0.5]).tolist()
    for level in levels[:int(rng.integers(3, 5))]:
        builder.go(level * travel, ramp)
        builder.wait(float(rng.uniform(20.0, 60.0)))
    builder.go(0.0, ramp)
    builder.wait(20.0)
    return _attached('slow', builder.experiment('slow'), travel, force, 1.0 / ramp, rate, rng)


def _attached(
    stage: str, experiment: Experiment, travel: float, force: float, fastest: float,
    rate: float, rng: Generator,
) -> Rig:
    """Put a specimen of a given force range under a motion."""
    stiffness = force / travel
    damping = stiffness / (2.0 * pi * fastest) * log_uniform(rng, 0.03, 0.3)
    wall = WallParameters(stiffness=_digits(stiffness), damping=_digits(damping), location=0.0,
                          inertia=0.0, unilateral=False)
    sensors = _sensors(rate, force, travel, 2.0 * fastest * travel, rng)
    return Rig(stage, wall, None, sensors, experiment,
               draw_nuisances(force, travel, sensors.force_noise, rng), travel)


def _draw_drive(rng: Generator) -> Rig:
    """Draw a mass on a guide, moved to and fro."""
    rate = float(rng.choice([200.0, 500.0, 1000.0]))
    travel, mass = log_uniform(rng, 0.02, 0.2), log_uniform(rng, 1.0, 90.0)
    frequency = float(rng.uniform(0.4, 1.5))
    builder = Builder(Stage(0.0, 0.0, travel))
    for level in rng.permutation([0.5, 1.0, 0.3, 0.8]).tolist():
        builder.wait(float(rng.uniform(0.2, 0.6)))
        builder.go(level * travel, float(rng.uniform(0.3, 1.0)) / frequency)
        if rng.uniform() < 0.5:
            omegas = (2.0 * pi * frequency * rng.uniform(0.3, 2.0, 4)).tolist()
            builder.hold(float(rng.uniform(1.5, 3.0)), Multisine(0.2 * travel, omegas))
        builder.go(0.0, float(rng.uniform(0.3, 1.0)) / frequency)
    builder.wait(0.4)
    experiment = builder.experiment('drive')
    greatest = max(abs(experiment.desired(0.01 * k).acceleration)
                   for k in range(int(100.0 * experiment.duration)))
    force, speed = mass * greatest, 2.0 * frequency * travel
    wall = WallParameters(
        stiffness=0.0, damping=_digits(force / speed * log_uniform(rng, 0.1, 0.5)), location=0.0,
        inertia=_digits(mass), unilateral=False)
    sensors = replace(_sensors(rate, force, travel, speed, rng),
                      position_noise=_digits(travel * log_uniform(rng, 3e-6, 2e-5)),
                      position_step=_digits(travel * log_uniform(rng, 3e-6, 2e-5), 1))
    return Rig('drive', wall, None, sensors, experiment,
               draw_nuisances(force, travel, sensors.force_noise, rng), travel)


STAGES: Mapping[str, Callable[[Generator], Rig]] = {
    'press': _draw_press, 'specimen': _draw_specimen, 'slow': _draw_slow, 'drive': _draw_drive,
}
"""Draws by kind of experiment."""
