# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Speed of node, estimators and replay, each against a reference in the same run."""

from contextlib import redirect_stderr, redirect_stdout
from functools import partial
import gc
import io
from math import pi
import os
from pathlib import Path
import platform
from statistics import median
from tempfile import TemporaryDirectory
import time
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from ..commands.command_line import as_json, check_outputs, command, Parser, write_results
from ..commands.replay import main as replay
from ..estimators import MULTIPLE_MODEL, ONLINE_ESTIMATORS
from ..estimators.estimate import Frozen
from ..estimators.estimator import TimedRow
from ..exceptions import ContactEstimationError, ParameterRangeError
from ..parameters import build
from ..pipeline.axis_pipeline import EstimationPipeline
from ..pipeline.parameters import EstimationParameters
from ..pipeline.session import ContactSession
from ..plant.closed_loop import run_closed_loop
from ..plant.plant_parameters import PAPER_NOISE, PlantParameters
from ..plant.simulation import simulate_experiment, write_simulation
from ..recordings import RecordingReader
from ..reference.experiment import Experiment, Sine
from ..reference.experiments import experiment_named, manoeuvre
from ..reference.setpoints import Reference
from ..signals.contact_sample import ContactSample
from ..texts import markdown_table

RATE = 500.0
_TOPICS = 'wrench', 'joint_states'
_CONTACT_S, _SETTLED_S = 12.0, 8.6  # of the estimators; of it, two seconds into the hold
_MANOEUVRES, _ROUNDS = 30, 3  # of a simulated recording, 6 min; of replay
_BLOCK = 250  # samples; short, so that all candidates see the same load of the machine
_VARIANCE = 1.0 / 3.0  # of the simulated force noise [N^2]
_FILTERPY = 'filterpy KalmanFilter'
_REPLAYED = MULTIPLE_MODEL, 'indirect_adaptive', 'rls'

Steps = Callable[[int, int], None]
"""Passes samples from one number to another."""

Pair = tuple[ContactSample, Reference]
"""A sample, and the reference that the robot followed."""


def contact_data() -> tuple[list[Pair], list[Pair]]:
    """Simulate an approach, and a contact with 3 Hz excitation and the paper's noise."""
    session = ContactSession(build(EstimationParameters, {'sample_rate': RATE}))
    results = run_closed_loop(
        build(PlantParameters, PAPER_NOISE), session,
        manoeuvre('pressing', Sine(8.0, 6.0 * pi), hold_s=_CONTACT_S + 3.0),
        _SETTLED_S + _CONTACT_S).results
    pairs = [(now.sample, before.reference) for before, now in zip(results, results[1:])
             if before.reference is not None]
    return pairs[:round(_SETTLED_S * RATE)], pairs[round(_SETTLED_S * RATE):]


def _settled(approach: Sequence[Pair], name: str) -> EstimationPipeline:
    """Build a pipeline that has processed the approach."""
    pipeline = EstimationPipeline(
        build(EstimationParameters, {'estimator': name, 'sample_rate': RATE}))
    for sample, reference in approach:
        pipeline.process((sample,), reference)
    return pipeline


def estimator_rows(approach: Sequence[Pair], contact: Sequence[Pair], name: str) -> list[TimedRow]:
    """Collect the rows that a pipeline passes to an estimator that runs on rows."""
    pipeline, rows = _settled(approach, name), list[TimedRow]()
    assert pipeline.estimator is not None
    update = pipeline.estimator.update

    def record(part: Sequence[TimedRow], variance: float, frozen: Frozen) -> list[Any]:
        rows.extend(part)
        return update(part, variance, frozen)

    setattr(pipeline.estimator, 'update', record)
    for sample, reference in contact:
        pipeline.take(sample, reference)
    return rows


def _session_steps(approach: Sequence[Pair], contact: Sequence[Pair], name: str) -> Steps:
    """Prepare a whole session: synchroniser, pipeline and reference, message by message."""
    session = ContactSession(build(EstimationParameters, {'estimator': name, 'sample_rate': RATE}))

    def add(pairs: Sequence[Pair]) -> None:
        for (stamp_ns, position, velocity, force), _ in pairs:
            session.add_motion(stamp_ns, position, velocity)
            session.add_wrench(stamp_ns, force)

    add(approach)
    return lambda begin, end: add(contact[begin:end])


def _update_steps(approach: Sequence[Pair], contact: Sequence[Pair], name: str) -> Steps:
    """Prepare a bare estimator, row by row."""
    pipeline = _settled(approach, name)
    calls: Sequence[tuple[Any, ...]]
    if pipeline.estimator is None:
        update: Callable[..., Any] = pipeline.posterior.take
        pipeline.posterior.restart()  # its time began with the approach
        calls = [(1e-9 * stamp_ns, -force, x, v) for (stamp_ns, x, v, force), _ in contact]
    else:
        update = pipeline.estimator.update
        calls = [((row,), _VARIANCE, Frozen(False, False))
                 for row in estimator_rows(approach, contact, name)]

    def steps(begin: int, end: int) -> None:
        for call in calls[begin:end]:
            update(*call)

    return steps


def _filterpy_steps(approach: Sequence[Pair], contact: Sequence[Pair]) -> Steps:
    """Prepare filterpy's Kalman filter for (K_e, B_e, c) with one scalar force per step."""
    from filterpy.kalman import KalmanFilter

    kalman = KalmanFilter(dim_x=3, dim_z=1)
    kalman.x = np.array([[3000.0], [50.0], [0.0]])
    kalman.P, kalman.Q = np.diag([1e6, 1e4, 1.0]), np.diag([1.0, 0.1, 1e-6])
    rows = [(row[0], np.array([row[1:4]]))
            for _, row in estimator_rows(approach, contact, 'indirect_adaptive')]

    def steps(begin: int, end: int) -> None:
        for y, phi in rows[begin:end]:
            kalman.predict()
            kalman.update(y, R=_VARIANCE, H=phi)

    return steps


def _longest(steps: Steps, count: int) -> float:
    """Return what one sample in a thousand exceeds: CPU time [us]."""
    spent = []
    for k in range(count):
        start = time.thread_time()
        steps(k, k + 1)
        spent.append(1e6 * (time.thread_time() - start))
    return float(np.quantile(spent, 0.999))


def estimator_benchmark(options: Any) -> list[dict[str, Any]]:
    """Time all estimators on the same samples, alternating: CPU time per sample [us], medians."""
    data = contact_data()
    candidates: dict[str, Steps] = {_FILTERPY: _filterpy_steps(*data)}
    for name in ONLINE_ESTIMATORS:
        candidates[f'{name} session'] = _session_steps(*data, name)
        candidates[f'{name} update'] = _update_steps(*data, name)
    spent: dict[str, list[float]] = {name: [] for name in candidates}
    gc.collect()
    gc.freeze()  # as the node does
    for begin in range(0, len(data[1]) - _BLOCK + 1, _BLOCK):
        for name, steps in candidates.items():
            start = time.thread_time()
            steps(begin, begin + _BLOCK)
            spent[name].append(1e6 * (time.thread_time() - start) / _BLOCK)
    gc.unfreeze()
    us = {name: median(times[1:]) for name, times in spent.items()}  # the first is warm-up
    longest = {name: _longest(_session_steps(*data, name), len(data[1]))
               for name in ONLINE_ESTIMATORS}
    rows = [{'estimator': name,
             **{f'{part} [us]': us[f'{name} {part}'] for part in ('session', 'update')},
             **{f'{part}/filterpy': us[f'{name} {part}'] / us[_FILTERPY]
                for part in ('session', 'update')},
             'session 99.9 %/filterpy': longest[name] / us[_FILTERPY]}
            for name in ONLINE_ESTIMATORS]
    return [*rows, {**dict.fromkeys(rows[0]), 'estimator': _FILTERPY, 'update [us]': us[_FILTERPY],
                    'update/filterpy': 1.0}]


def write_long_recording(path: Path, in_contact: bool = False) -> None:
    """Write the manoeuvre with a sine again and again, a third in contact; or one long hold."""
    sine = experiment_named('sine')  # it ends at rest at its start position
    experiment = Experiment('often', sine.start, sine.segments * _MANOEUVRES)
    if in_contact:
        experiment = manoeuvre(
            'pressing', None, Sine(1e-3, 6.0 * pi), hold_s=_MANOEUVRES * sine.duration)
    simulation = simulate_experiment(build(PlantParameters, PAPER_NOISE), experiment)
    write_simulation(path, simulation, 'x', 'contact_x', 'contact_frame')


def _deserialised(path: Path) -> None:
    """Deserialise every message of the two topics into an object."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import get_typestore, Stores

    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
        wanted = [one for one in reader.connections if one.topic.strip('/') in _TOPICS]
        for connection, _, data in reader.messages(wanted):
            reader.deserialize(data, connection.msgtype)


def _read(path: Path) -> None:
    for _ in RecordingReader(path).batches(_TOPICS):
        pass


def _replayed(name: str, path: Path) -> None:
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        if replay([str(path), '--estimator', name]):
            raise ContactEstimationError(f'replay of {path} failed with {name}')
    gc.enable()  # replay runs without, and so would what follows


def replay_benchmark(options: Any) -> list[dict[str, Any]]:
    """Time replay of one recording, or of two that are simulated: mixed, and all in contact."""
    if options.recording:
        return _replay_rows('', Path(options.recording))
    rows = []
    with TemporaryDirectory() as folder:
        for name in ('mixed', 'in contact'):
            path = Path(folder) / f'{name}.mcap'
            write_long_recording(path, name == 'in contact')
            rows += _replay_rows(name, path)
    return rows


def _replay_rows(recording: str, path: Path) -> list[dict[str, Any]]:
    """Alternate replay, reading and rosbags on one recording."""
    tasks: dict[str, Callable[[Path], None]] = {
        'rosbags deserialise': _deserialised, 'RecordingReader': _read,
        **{f'replay {name}': partial(_replayed, name) for name in _REPLAYED}}
    spent: dict[str, list[float]] = {name: [] for name in tasks}
    for _ in range(_ROUNDS):
        for name, task in tasks.items():
            start = time.process_time()
            task(path)
            spent[name].append(time.process_time() - start)
    reference = spent['rosbags deserialise']
    return [{'recording': recording, 'task': name, 'CPU [s]': median(own),
             'CPU/rosbags': median(a / b for a, b in zip(own, reference))}
            for name, own in spent.items()]


def node_benchmark(options: Any) -> list[dict[str, Any]]:
    """Compare the node with one that only echoes; imported here, as it needs ROS."""
    from .speed_nodes import compared_nodes

    return compared_nodes(options.estimator)


BENCHMARKS: Mapping[str, Callable[[Any], list[dict[str, Any]]]] = {
    'estimators': estimator_benchmark, 'node': node_benchmark, 'replay': replay_benchmark}


def make_parser() -> Parser:
    """Build the command line of the benchmarks."""
    parser = Parser(
        prog='studies speed',
        description='Measure run times and their ratios to a reference measured in the same run: '
        "estimators against filterpy's KalmanFilter, the node against an rclpy node that only "
        'echoes, replay against rosbags deserialising the same file. Other load on the machine '
        'affects all times; the ratios are the most robust.')
    parser.add_argument('which', nargs='*', metavar='BENCHMARK',
                        help=f'any of {", ".join(BENCHMARKS)} (default: all)')
    parser.add_argument('--json', metavar='FILE', help='write all results as JSON')
    parser.add_argument('--estimator', choices=ONLINE_ESTIMATORS, default=MULTIPLE_MODEL,
                        help='estimator of the node (default: %(default)s)')
    parser.add_argument('--recording', metavar='RECORDING',
                        help='replay this (default: a simulated one)')
    return parser


def run(options: Any) -> int:
    """Run the chosen benchmarks."""
    for name in options.which:
        if name not in BENCHMARKS:
            raise ParameterRangeError(
                f'BENCHMARK must be among {", ".join(BENCHMARKS)}, got {name!r}')
    check_outputs([options.json], {})
    results: dict[str, Any] = {'machine': {
        'processors': os.cpu_count(), 'python': platform.python_version(),
        'system': platform.platform(), 'load_average': os.getloadavg()}}
    for name in options.which or BENCHMARKS:
        rows = results[name] = BENCHMARKS[name](options)
        print(markdown_table(list(rows[0]), [map(_text, row.values()) for row in rows]) + '\n')
    write_results(options, {'json': lambda: as_json(results)})
    return 0


def _text(value: Any) -> str:
    return '-' if value is None else f'{value:.4g}' if isinstance(value, float) else str(value)


main = command(make_parser, run)
