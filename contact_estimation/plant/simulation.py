# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A simulated recording: the plant on a recorded command or force, or on an experiment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .between_samples import BETWEEN
from .driven_wall import run_driven_wall_with_rates
from .open_loop import simulate_at
from .plant_parameters import PlantParameters
from .sampled_reference import reference_through
from .sensors import Sensors
from .world import Truth
from ..reference.experiment import Experiment
from ..reference.setpoints import Reference

Array = NDArray[np.float64]
Stamps = NDArray[np.int64]


@dataclass(frozen=True)
class Simulation:
    """Measurements of a simulated world, and the reference of its robot."""

    stamp_ns: Stamps  # (N,) stamps of the samples [ns]
    measured: Array  # (3, N) F_e [N], x [m] and its rate [m/s], NaN where not published
    reference_ns: Stamps  # (M,) stamps of the reference [ns]
    # (4, M) x_r [m], its rate [m/s] and acceleration [m/s^2], F_r [N]; M = 0 without a robot
    reference: Array


def simulate_command(
    model: PlantParameters, stamp_ns: Stamps, reference_ns: Stamps, reference: Array,
    start: tuple[float, float], held: bool = False,
) -> Simulation:
    """
    Simulate a model on a recorded reference.

    stamp_ns (N,): stamps of the measurements [ns], increasing
    start: position [m] and velocity [m/s] of the robot at the first stamp
    held: whether the robot holds each setpoint until the next; else it interpolates linearly
    """
    first = stamp_ns[0]
    follow = reference_through((reference_ns - first) * 1e-9, reference, held)
    truths = simulate_at(model, (stamp_ns - first) * 1e-9, follow, *start)
    return Simulation(stamp_ns, _measured(model, truths), reference_ns, reference)


def simulate_experiment(model: PlantParameters, experiment: Experiment) -> Simulation:
    """Simulate a model on the setpoints of an experiment."""
    count = round(experiment.duration * model.sample_rate) + 1
    stamp_ns = np.round(1e9 / model.sample_rate * np.arange(count)).astype(np.int64)
    desired = [experiment.desired(t) for t in (stamp_ns * 1e-9).tolist()]
    reference = np.array([Reference(*d[:3]) for d in desired]).T
    start = desired[0].position, desired[0].velocity
    return simulate_command(model, stamp_ns, stamp_ns, reference, start)


def simulate_force(
    model: PlantParameters, stamp_ns: Stamps, force: Array, start: tuple[float, float],
    between: str = 'straight',
) -> Simulation:
    """
    Simulate an attached wall without a robot on a measured force.

    stamp_ns (N,): stamps of the force [ns], increasing
    force (N,): measured F_e [N]
    start: position [m] and velocity [m/s] at the first stamp
    between: behaviour of the force between its samples, a key of `BETWEEN`
    """
    t = (stamp_ns - stamp_ns[0]) * 1e-9
    motion = run_driven_wall_with_rates(model, t, BETWEEN[between](force), *start)
    columns = zip(t.tolist(), *motion.tolist(), force.tolist(), force.tolist())
    measured = _measured(model, [Truth(*column) for column in columns])
    nothing = np.empty(0, np.int64), np.empty((4, 0))
    return Simulation(stamp_ns, measured, *nothing)


def _measured(model: PlantParameters, truths: list[Truth]) -> Array:
    sensors = Sensors(model)
    return np.array([sensors.measure(truth) for truth in truths]).T
