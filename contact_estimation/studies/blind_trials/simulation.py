# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Noise-free simulation of a randomised world, with or without an effect."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .worlds import RandomWorld
from ...parameters.values import build, flatten
from ...physics.random_strength import Values
from ...physics.scales import Scales
from ...plant.plant_parameters import PlantParameters
from ...plant.world import World

Array = NDArray[np.float64]

SEARCH_HZ = 2000.0
"""Minimum integration rate while the strength of an effect is searched."""


class Run(NamedTuple):
    """True signals of a world, all of shape (N,)."""

    t: Array  # time, evenly spaced [s]
    # x, v, force: position [m] and velocity [m/s] of the end-effector, and F_e [N]
    x: Array
    v: Array
    force: Array
    sensed: Array  # F_e after the effects at the force sensor [N]
    # x_r, v_r, a_r: reference [m], [m/s], [m/s^2]
    x_r: Array
    v_r: Array
    a_r: Array


def simulate(
    world: RandomWorld, physics: Values, rate: float, integration_rate: float = SEARCH_HZ
) -> Run:
    """
    Simulate the experiment of a world.

    physics: effect parameters by dotted name, such as coulomb_friction.F_c. Empty: no effect.
    rate: sample rate of the result [Hz]
    integration_rate: minimum integration rate [Hz]
    """
    experiment = world.experiment
    parameters = build(PlantParameters, {
        **flatten(world.wall, 'environment.'), **flatten(world.robot, 'robot.'),
        **{f'physics.{dotted}': value for dotted, value in physics.items()},
        'sample_rate': rate, 'integration_rate': integration_rate,
    })

    def reference(t: float) -> tuple[float, float, float, float]:
        desired = experiment.desired(t)
        return desired.position, desired.velocity, desired.acceleration, 0.0

    plant = World(parameters, experiment.start)
    rows = []
    for k in range(round(experiment.duration * rate) + 1):
        _, x, v, _, force, sensed = plant.truth(reference)
        rows.append((k / rate, x, v, force, sensed, *reference(k / rate)[:3]))
        plant.advance((k + 1) / rate - plant.t, reference)
    return Run(*np.array(rows).T)


def scales_of(world: RandomWorld, run: Run) -> Scales:
    """Compute the characteristic magnitudes of a world."""
    robot, touching = world.robot, run.force < 0.0
    control = (robot.mass * run.a_r - robot.damping * (run.v - run.v_r)
               - robot.stiffness * (run.x - run.x_r))
    return Scales(
        depth=float(np.max(run.x - world.wall.location)),
        speed=float(np.percentile(np.abs(run.v[touching]), 98)) if touching.any() else 1e-3,
        force=float(-np.min(run.force)), control=float(np.max(np.abs(control))),
        greatest_pull=0.0, duration=float(run.t[-1]), stiffness=world.wall.stiffness,
        damping=world.wall.damping, mass=robot.mass,
        sample_period=float(run.t[1] - run.t[0]),
    )
