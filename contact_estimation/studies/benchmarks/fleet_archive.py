# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A simulated archive of three robots: one wears, one gets friction, some files are broken."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Callable

from ...parameters.values import build
from ...physics import PhysicsParameters
from ...plant.plant_parameters import PlantParameters, SensorParameters, WallParameters
from ...plant.simulation import simulate_experiment, write_simulation
from ...reference.experiment import Experiment, Multisine, Segment

ROBOTS = ('robot_a', 'robot_b', 'robot_c')
WORN, RUBBING = 'robot_b', 'robot_c'
WEAR = 0.002  # of the stiffness, per recording of the robot
FRICTION_AT = 0.6  # of the archive: the 120th of 200
LEAST_S = 9.0

_NOMINAL = """plant_node:
  ros__parameters:
    environment: {stiffness: 4300.0, damping: 260.0}
"""
_SENSORS = SensorParameters(force_noise=0.3, position_noise=3e-6, position_quantisation=1e-6)
_START_NS = 1_767_600_000 * 10**9  # 2026-01-05
_BETWEEN_NS = 3600 * 10**9
_OVERHEAD_S = 6.9  # of three touches besides their holds


def write_archive(folder: Path, count: int, seconds: float) -> Path:
    """
    Write an archive and its nominal model.

    count: number of recordings, of which 4 are broken
    seconds: duration of each [s]
    """
    experiment = touches(seconds)
    broken = {round((place + 0.5) * count / len(_BREAKERS)): breaker
              for place, breaker in enumerate(_BREAKERS)}
    for robot in ROBOTS:
        (folder / robot).mkdir(parents=True, exist_ok=True)
    for number in range(1, count + 1):
        robot = ROBOTS[(number - 1) % len(ROBOTS)]
        path = folder / robot / f'run_{number:03d}.mcap'
        if number in broken:
            broken[number](path)
        else:
            _write(path, world(robot, number, count), experiment, number)
    nominal = folder / 'nominal.yaml'
    nominal.write_text(_NOMINAL)
    return nominal


def world(robot: str, number: int, count: int) -> PlantParameters:
    """Return the world of a recording."""
    uses = (number - 1) // len(ROBOTS)
    stiffness = 4800.0 * ((1.0 - WEAR) ** uses if robot == WORN else 1.0)
    rubs = robot == RUBBING and number >= FRICTION_AT * count
    physics = build(PhysicsParameters, {'coulomb_friction.F_c': 6.0} if rubs else {})
    return PlantParameters(
        environment=WallParameters(stiffness=stiffness), sensors=_SENSORS, physics=physics,
        seed=number)


def touches(seconds: float) -> Experiment:
    """
    Return three touches like those of the experiment `rich`, of any duration.

    seconds: duration [s], at least `LEAST_S`
    """
    away, hold = -0.02, (seconds - _OVERHEAD_S) / 3.0
    segments = [Segment(0.5, away)]
    for approach_s, depth, amplitude, omegas in (
        (0.8, 0.012, 0.002, [5.0, 11.0, 23.0]), (0.5, 0.020, 0.003, [4.0, 9.0, 17.0]),
        (1.5, 0.024, 0.002, [6.0, 13.0, 27.0]),
    ):
        segments += [
            Segment(approach_s, depth), Segment(0.3, depth),
            Segment(hold, depth, position_excitation=Multisine(amplitude, omegas)),
            Segment(0.8, away),
        ]
    return Experiment('touches', away, (*segments, Segment(0.3, away)))


def _write(path: Path, model: PlantParameters, experiment: Experiment, number: int) -> None:
    simulation = simulate_experiment(model, experiment)
    start = _START_NS + number * _BETWEEN_NS
    path.unlink(missing_ok=True)
    write_simulation(path, replace(simulation, stamp_ns=simulation.stamp_ns + start,
                                   reference_ns=simulation.reference_ns + start),
                     'x', 'contact', 'tool')


def _empty(path: Path) -> None:
    path.write_bytes(b'')


def _text(path: Path) -> None:
    path.write_text('this is not a recording\n')


def _only_start(path: Path) -> None:
    path.write_bytes(b'\x89MCAP0\r\n')


def _incomplete_bag(path: Path) -> None:
    bag = path.with_suffix('')
    bag.mkdir(exist_ok=True)
    (bag / 'metadata.yaml').write_text(
        'rosbag2_bagfile_information: {relative_file_paths: [lost_0.mcap]}\n')


_BREAKERS: tuple[Callable[[Path], None], ...] = (_empty, _text, _only_start, _incomplete_bag)
