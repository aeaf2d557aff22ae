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

"""A setup run through the plant, with or without an effect."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .setups import Setup
from .unknown import made, UNKNOWN
from ..parameters.values import build, flatten
from ..physics.random_strength import Values
from ..physics.scales import Scales
from ..plant.plant_parameters import PlantParameters
from ..plant.world import World

Array = NDArray[np.float64]

COARSE_HZ = 2000.0
"""Least rate of integration while a magnitude is searched."""


class Run(NamedTuple):
    """
    A world over time, before noise; all of shape (N,).

    Attributes
    ----------
    t : ndarray
        Evenly spaced [s].
    x, v, force : ndarray
        Of the end-effector [m], [m/s], and F_e [N].
    sensed : ndarray
        What the physics of the force sensor make of F_e [N].
    x_r, v_r, a_r : ndarray
        The reference [m], [m/s], [m/s^2].

    """

    t: Array
    x: Array
    v: Array
    force: Array
    sensed: Array
    x_r: Array
    v_r: Array
    a_r: Array


def simulate(
    setup: Setup, physics: Values, rate: float, integration_rate: float = COARSE_HZ
) -> Run:
    """
    Run the experiment.

    Parameters
    ----------
    setup : Setup
        The world.
    physics : mapping
        Parameters of effects by dotted name, such as coulomb_friction.F_c; those of UNKNOWN too;
        empty: none.
    rate : float
        Of what is noted down [Hz].
    integration_rate : float
        Least rate of integration steps [Hz].

    Returns
    -------
    run : Run
        From 0 to the end of the experiment.

    """
    experiment = setup.experiment
    known: dict[str, float] = {}
    further: dict[str, dict[str, float]] = {}
    for dotted, value in physics.items():
        effect, name = dotted.split('.')
        if effect in UNKNOWN:
            further.setdefault(effect, {})[name] = value
        else:
            known[f'physics.{dotted}'] = value
    plant = build(PlantParameters, {
        **flatten(setup.wall, 'environment.'), **flatten(setup.robot, 'robot.'),
        **known,
        'sample_rate': rate, 'integration_rate': integration_rate,
    })

    def reference(t: float) -> tuple[float, float, float, float]:
        wanted = experiment.desired(t)
        return wanted.position, wanted.velocity, wanted.acceleration, 0.0

    world = World(plant, experiment.start,
                  further=[made(name, values) for name, values in further.items()])
    rows = []
    for k in range(round(experiment.duration * rate) + 1):
        _, x, v, _, force, sensed = world.truth(reference)
        rows.append((k / rate, x, v, force, sensed, *reference(k / rate)[:3]))
        world.advance((k + 1) / rate - world.t, reference)
    return Run(*np.array(rows).T)


def scales_of(setup: Setup, run: Run) -> Scales:
    """
    Measure how large things are in a world.

    Parameters
    ----------
    setup : Setup
        The world.
    run : Run
        Without effects.

    Returns
    -------
    scales : Scales
        As an effect's own search would be given.

    """
    robot, inside = setup.robot, run.force < 0.0
    control = (robot.mass * run.a_r - robot.damping * (run.v - run.v_r)
               - robot.stiffness * (run.x - run.x_r))
    return Scales(
        depth=float(np.max(run.x - setup.wall.location)),
        speed=float(np.percentile(np.abs(run.v[inside]), 98)) if inside.any() else 1e-3,
        force=float(-np.min(run.force)), control=float(np.max(np.abs(control))),
        greatest_pull=0.0, duration=float(run.t[-1]), stiffness=setup.wall.stiffness,
        damping=setup.wall.damping, mass=robot.mass,
    )
