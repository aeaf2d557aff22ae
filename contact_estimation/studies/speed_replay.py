# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The command `replay` compared with deserialising the same recording by rosbags."""

from __future__ import annotations

from itertools import chain, cycle, islice
from pathlib import Path
import re
from statistics import median
import sys
from tempfile import TemporaryDirectory
from typing import Any, Iterator

from .measuring import Cost, print_table, run_timed
from .speed_estimators import pressing, RATE, simulated
from ..estimators import MULTIPLE_MODEL
from ..exceptions import ContactEstimationError, RecordingError
from ..pipeline.axes import Result
from ..recordings import RecordingReader, RecordingWriter
from ..recordings.encoding import JointStateEncoder, WrenchEncoder
from ..reference.experiments import experiment_named

_BEGIN_NS = 1_700_000_000_000_000_000
_PERIOD_NS = round(1e9 / RATE)
_CYCLE_S = 12.0
_TRANSPORT_NS = 200_000  # from stamp to log time


def write_long_recording(folder: Path, hours: float, contact: str) -> None:
    """
    Write wrench and joint_states at 500 Hz with advancing stamps to a new rosbag2 folder.

    contact: 'mixed': the sine manoeuvre of 12 s repeated, one third in contact; 'always': one
    approach, then contact under excitation to the end
    """
    wrenches = WrenchEncoder('contact_frame')
    joints = JointStateEncoder('contact_frame', 'contact_x', True)
    with RecordingWriter.folder(folder) as writer:
        samples = islice(_endless(contact), round(hours * 3600.0 * RATE))
        for k, (_, position, velocity, force) in enumerate(r.sample for r in samples):
            stamp_ns = _BEGIN_NS + k * _PERIOD_NS
            log_ns = stamp_ns + _TRANSPORT_NS
            data = joints.encode(stamp_ns, position, velocity)
            writer.write('/joint_states', 'sensor_msgs/msg/JointState', data, log_ns)
            data = wrenches.encode(stamp_ns, force, 0.0, 0.0)
            writer.write('/wrench', 'geometry_msgs/msg/WrenchStamped', data, log_ns)


def _endless(contact: str) -> Iterator[Result]:
    if contact == 'mixed':
        sine = experiment_named('sine')  # it ends at rest at its start position
        return cycle(simulated(sine, sine.duration))
    approach, pressed = pressing(_CYCLE_S)
    return chain(approach, cycle(pressed))


_REFERENCE = 'rosbags deserialise'
_ESTIMATORS = (MULTIPLE_MODEL, 'indirect_adaptive', 'rls')


def run_replay_benchmark(
    recording: str | None, hours: float, contact: str, rounds: int
) -> dict[str, Any]:
    """Alternate replay and the references on one recording; without one, write it."""
    if recording is not None:
        return _measure(Path(recording), Path(recording).name, rounds)
    with TemporaryDirectory() as folder:
        path = Path(folder) / 'recording'
        write_long_recording(path, hours, contact)
        return _measure(path, f'{hours:g} h of {contact} contact', rounds)


def _measure(path: Path, title: str, rounds: int) -> dict[str, Any]:
    reader = RecordingReader(path)
    if reader.start_ns is None or reader.end_ns is None:
        raise RecordingError(f'{path} has no known length; give a complete recording')
    hours = (reader.end_ns - reader.start_ns) * 1e-9 / 3600.0
    tasks = _commands(path)
    costs: dict[str, list[Cost]] = {name: [] for name in tasks}
    for _ in range(rounds):
        for name, command in tasks.items():
            costs[name].append(run_timed(command))
            if costs[name][-1].error:
                raise ContactEstimationError(f'{name} failed: {costs[name][-1].error}')
    rows = [_row(name, costs, hours) for name in tasks]
    print_table(f'replay, {title}; start-up of Python included, medians of {rounds}', rows)
    return {'recording': title, 'hours': hours, 'tasks': rows}


def _commands(path: Path) -> dict[str, list[str]]:
    read = [sys.executable, '-m', 'contact_estimation.studies.reading_tasks']
    replay = [sys.executable, '-m', 'contact_estimation.commands.replay']
    return {
        _REFERENCE: [*read, 'rosbags', str(path)],
        'RecordingReader': [*read, 'reader', str(path)],
        **{f'replay {name}': [*replay, str(path), '--estimator', name] for name in _ESTIMATORS},
        'replay --help (start-up)': [*replay, '--help'],
    }


def _row(name: str, costs: dict[str, list[Cost]], hours: float) -> dict[str, Any]:
    reference, own = costs[_REFERENCE], costs[name]
    counted = re.search(r'(\d+) (?:samples|messages)', own[-1].text)
    return {
        'task': name,
        'count': int(counted.group(1)) if counted else None,
        'wall_s': median(cost.wall_s for cost in own),
        's_per_hour': median(cost.wall_s for cost in own) / hours,
        'cpu_s_per_hour': median(cost.cpu_s for cost in own) / hours,
        'peak_mb': median(cost.peak_mb for cost in own),
        'wall/rosbags': median(a.wall_s / b.wall_s for a, b in zip(own, reference)),
        'cpu/rosbags': median(a.cpu_s / b.cpu_s for a, b in zip(own, reference)),
        'memory/rosbags': median(a.peak_mb / b.peak_mb for a, b in zip(own, reference)),
    }
