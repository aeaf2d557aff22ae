# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The plant on a given reference, without an estimator."""

from __future__ import annotations

from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .plant_parameters import PlantParameters
from .sampled_reference import reference_through
from .sensors import Sensors
from .world import Truth, World
from ..physics.effect import Effect
from ..reference.setpoints import ReferenceAt
from ..signals.contact_sample import ContactRecording, ContactSample

Array = NDArray[np.float64]


def run_open_loop(
    plant: PlantParameters, reference: ReferenceAt, start: float, duration: float,
    further: Sequence[Effect] = (),
) -> tuple[list[Truth], ContactRecording]:
    """
    Simulate the plant on a given reference.

    reference: from time [s] to the reference
    start: initial position of the robot, at rest [m]
    duration: simulated time [s]
    """
    period = 1.0 / plant.sample_rate
    world, sensors = World(plant, start, further=further), Sensors(plant)
    truths: list[Truth] = []
    samples: list[ContactSample] = []
    for k in range(round(duration * plant.sample_rate)):
        truth = world.truth(reference)
        force, position, velocity = sensors.measure(truth)
        truths.append(truth)
        samples.append(ContactSample(round(1e9 * k * period), position, velocity, force))
        world.advance(period, reference)
    return truths, ContactRecording.of(samples)


def simulate_on(
    parameters: PlantParameters, t: Array, reference_rows: Array, x0: float, v0: float = 0.0,
    begin: float = 0.0,
) -> list[Truth]:
    """
    Simulate on a sampled reference, interpolated linearly.

    parameters: parameters of the world. At 500 Hz, an `integration_rate` of one or two steps per
    sample suffices unless dry friction acts on a light robot.
    t (N,): times of the samples [s], increasing
    reference_rows (4, N): x_r [m], its rate [m/s] and acceleration [m/s^2], F_r [N] (0: none)
    x0, v0: position [m] and velocity [m/s] of the robot at t[0]
    begin: the world's time at t[0] [s], on which some effects depend
    """
    since = t - t[0] + begin
    return simulate_at(
        parameters, since, reference_through(since, reference_rows), x0, v0, begin)


def simulate_at(
    parameters: PlantParameters, t: Array, reference: ReferenceAt, x0: float, v0: float = 0.0,
    begin: float = 0.0,
) -> list[Truth]:
    """
    Simulate, and return the true states at given times.

    t (N,): output times [s], >= begin, increasing
    reference: from time [s] to the reference
    """
    world, truths = World(parameters, x0, v0, begin=begin), []
    for now in t.tolist():
        if now > world.t:
            world.advance(now - world.t, reference)
        truths.append(world.truth(reference))
    return truths
