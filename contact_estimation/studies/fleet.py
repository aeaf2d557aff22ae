# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The demonstration of `fleet`: a simulated archive, its scaling, a kill and a Dask cluster."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace
import json
import os
from pathlib import Path
import random
import re
import signal
import subprocess
import sys
import time
from typing import Any, Callable, Iterator, Sequence

from ..commands.command_line import command, new_folder, Parser, require_at_least
from ..exceptions import FleetError
from ..parameters import build
from ..physics import PhysicsParameters
from ..plant.plant_parameters import PlantParameters, SensorParameters, WallParameters
from ..plant.simulation import simulate_experiment, write_simulation
from ..reference.experiment import Experiment, Multisine, Segment

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
    """Write an archive of `count` recordings of some seconds, 4 broken, and its model."""
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
    """Return three touches like those of `rich` in so many seconds, at least `LEAST_S`."""
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

_GROUPS = '(robot_[a-z])/'
_LEAST_RECORDINGS = 12
_START_S = 60.0


def make_parser() -> Parser:
    """Build the command line of the benchmark."""
    parser = Parser(
        prog='studies fleet',
        description='Write an archive of three simulated robots, of which one wears by 0.2 % a '
        'recording and one has dry friction from the 120th recording of 200 on, with 4 broken '
        'files, and run `fleet` over it: with 1 and 2 workers, killed at a random time and '
        'started again, and on a `dask scheduler` with two `dask worker` processes. All tables '
        'must be equal, and nothing that was finished may be done again.',
    )
    parser.add_argument('--output', required=True, metavar='DIR', help='new folder for everything')
    parser.add_argument('--recordings', type=int, default=200, help='recordings (200)')
    parser.add_argument('--seconds', type=float, default=20.0, help='duration of each [s] (20)')
    parser.add_argument('--seed', type=int, default=0,
                        help='of the random time at which the run is killed (0)')
    parser.add_argument('--only-write', action='store_true', help='write the archive alone')
    return parser


def run(options: Any) -> int:
    """Run the demonstration and print its figures."""
    require_at_least(options, recordings=_LEAST_RECORDINGS, seconds=LEAST_S)
    folder = new_folder(options.output)
    write_archive(folder / 'archive', options.recordings, options.seconds)
    if options.only_write:
        return 0
    seconds = {jobs: _timed(folder, f'jobs_{jobs}', '--jobs', str(jobs)) for jobs in (1, 2)}
    figures: dict[str, Any] = {
        'recordings': options.recordings, 'seconds': options.seconds,
        'wall_s_1_worker': seconds[1], 'wall_s_2_workers': seconds[2],
        'scaling': seconds[1] / seconds[2],
        'load_average': os.getloadavg(), 'processors': os.cpu_count(),
        'killed': _killed(folder, random.Random(options.seed).uniform(0.2, 0.8) * seconds[2]),
        'wall_s_cluster': _on_cluster(folder),
    }
    names = ('jobs_1', 'jobs_2', 'killed', 'cluster')
    tables = {(folder / name / 'table.parquet').read_bytes() for name in names}
    figures['equal_tables'] = len(tables) == 1
    text = json.dumps(figures, indent=1)
    (folder / 'figures.json').write_text(text + '\n')
    print(text)
    return 0 if figures['equal_tables'] and not figures['killed']['done_twice'] else 1


def _timed(folder: Path, name: str, *options: str) -> float:
    begin = time.perf_counter()
    subprocess.run(_fleet(folder, name, *options), cwd=folder, check=True)
    return time.perf_counter() - begin


def _fleet(folder: Path, name: str, *options: str) -> list[str]:
    return [sys.executable, '-m', 'contact_estimation.commands.fleet', 'archive', '--nominal',
            'archive/nominal.yaml', '--group-by', _GROUPS, '--output', name, *options]


def _killed(folder: Path, after_s: float) -> dict[str, Any]:
    """Kill a run, and its workers with it, start it again, and compare what was finished."""
    process = subprocess.Popen(_fleet(folder, 'killed', '--jobs', '2'), cwd=folder,
                               start_new_session=True)
    try:
        process.wait(after_s)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)  # a session of its own: nothing else
        process.wait()
    before = _finished(folder / 'killed')
    _timed(folder, 'killed', '--jobs', '2')
    after = _finished(folder / 'killed')
    return {'after_s': after_s, 'finished_then': len(before), 'finished_at_the_end': len(after),
            'done_twice': sum(after[name] != stamp for name, stamp in before.items())}


def _finished(folder: Path) -> dict[str, int]:
    """Return when each result was written."""
    return {file.name: file.stat().st_mtime_ns for file in folder.glob('finished/*.json')}


def _on_cluster(folder: Path) -> float:
    """Run on workers whose working directory is not that of the client."""
    with _started('scheduler', ['--port', '0', '--no-dashboard'], folder / 'scheduler') as address:
        options = [address, '--nthreads', '1', '--no-dashboard']
        with _started('worker', options, folder / 'worker_1'), \
                _started('worker', options, folder / 'worker_2'):
            return _timed(folder, 'cluster', '--scheduler', address)


@contextmanager
def _started(what: str, options: Sequence[str], folder: Path) -> Iterator[str]:
    """Start `dask scheduler` or `dask worker` in a folder of its own; yield its address."""
    folder.mkdir()
    with open(folder / 'log.txt', 'w') as log:
        process = subprocess.Popen([sys.executable, '-m', 'dask', what, *options], cwd=folder,
                                   stderr=log, stdout=log)
    try:
        yield _address(process, folder / 'log.txt')
    finally:
        process.terminate()
        process.wait(_START_S)


def _address(process: 'subprocess.Popen[bytes]', log: Path) -> str:
    end = time.monotonic() + _START_S
    while process.poll() is None and time.monotonic() < end:
        found = re.search(r'tcp://[^\s\']+:[1-9][0-9]*', log.read_text())
        if found:
            return found[0]
        time.sleep(0.1)
    raise FleetError(f'a process of Dask must write its address to {log}, but none came; read it')


main = command(make_parser, run)
