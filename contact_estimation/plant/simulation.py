# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Simulated recordings: the plant on a recorded command or force, or on an experiment."""

from dataclasses import dataclass
from pathlib import Path
from typing import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from .closed_loop import Sensors
from .driven_wall import BETWEEN, reference_through, run_driven_wall_with_rates
from .plant_parameters import PlantParameters
from .world import Truth, World
from ..physics.effect import Effect
from ..physics.numeric import Array
from ..recordings.encoding import JointStateEncoder, TrajectoryEncoder, WrenchEncoder
from ..recordings.writing import write_messages
from ..reference.experiment import Experiment
from ..reference.setpoints import Reference, ReferenceAt
from ..signals.contact_sample import ContactRecording, ContactSample


def run_open_loop(
    plant: PlantParameters, reference: ReferenceAt, start: float, duration: float,
    further: Sequence[Effect] = (),
) -> tuple[list[Truth], ContactRecording]:
    """Simulate the plant on a reference for a duration [s], from rest at a position [m]."""
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
    Simulate on a reference (4, N) at times (N,) [s], interpolated linearly, from x0 and v0.

    At 500 Hz, an `integration_rate` of one or two steps per sample suffices unless dry friction
    acts on a light robot. begin: the world's time at t[0] [s], on which some effects depend.
    """
    since = t - t[0] + begin
    return simulate_at(parameters, since, reference_through(since, reference_rows), x0, v0, begin)


def simulate_at(
    parameters: PlantParameters, t: Array, reference: ReferenceAt, x0: float, v0: float = 0.0,
    begin: float = 0.0,
) -> list[Truth]:
    """Return the true states at increasing times (N,) [s], none before `begin`."""
    world, truths = World(parameters, x0, v0, begin=begin), []
    for now in t.tolist():
        if now > world.t:
            world.advance(now - world.t, reference)
        truths.append(world.truth(reference))
    return truths


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
    """Simulate a model on a recorded reference, which the robot interpolates, or holds."""
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
    """Simulate an attached wall, without a robot, on a measured force, see `BETWEEN`."""
    t = (stamp_ns - stamp_ns[0]) * 1e-9
    motion = run_driven_wall_with_rates(model, t, BETWEEN[between](force), *start)
    columns = zip(t.tolist(), *motion.tolist(), force.tolist(), force.tolist())
    measured = _measured(model, [Truth(*column) for column in columns])
    return Simulation(stamp_ns, measured, np.empty(0, np.int64), np.empty((4, 0)))


def _measured(model: PlantParameters, truths: list[Truth]) -> Array:
    sensors = Sensors(model)
    return np.array([sensors.measure(truth) for truth in truths]).T


def write_simulation(
    path: Path, simulation: Simulation, axis: str, joint: str, frame_id: str
) -> None:
    """Write a simulation to an MCAP file."""
    setpoints = TrajectoryEncoder(frame_id, joint)
    references = [(stamp_ns, 'reference_trajectory', setpoints.encode(stamp_ns, *row))
                  for stamp_ns, row in zip(simulation.reference_ns.tolist(),
                                           simulation.reference.T.tolist())]
    write_messages(path, [*references, *_samples(simulation, axis, joint, frame_id)])


def _samples(
    simulation: Simulation, axis: str, joint: str, frame_id: str
) -> Iterator[tuple[int, str, bytes]]:
    force, position, velocity = simulation.measured.tolist()
    published = all(v == v for v in velocity)
    wrenches = WrenchEncoder(frame_id)
    joints = JointStateEncoder(frame_id, joint, published)
    place = 'xyz'.index(axis)
    for stamp_ns, F, x, v in zip(simulation.stamp_ns.tolist(), force, position, velocity):
        vector = [0.0, 0.0, 0.0]
        vector[place] = F
        yield stamp_ns, 'joint_states', joints.encode(stamp_ns, x, v)
        yield stamp_ns, 'wrench', wrenches.encode(stamp_ns, *vector)
