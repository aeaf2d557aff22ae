# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimator node against an echo node on the same topics, and in the loop with a live view."""

from __future__ import annotations

from functools import partial
import json
import os
from pathlib import Path
from statistics import median
import subprocess
import sys
from tempfile import TemporaryDirectory
import time
from typing import Any, Iterator, Mapping, Sequence

from .measuring import CpuMeter, machine_cpu_s, print_table, process_cpu_s
from ..exceptions import ContactEstimationError
from ..ros.loop_processes import end_process

_END_TIMEOUT_S = 5.0


def _own_domain() -> dict[str, str]:
    """Return the environment of processes in a ROS domain free of other traffic."""
    return {
        **os.environ,
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'ROS_DOMAIN_ID': str(1 + os.getpid() % 100),
    }


def start_node(
    module: str, parameters: list[str], remappings: Sequence[str] = ()
) -> subprocess.Popen[bytes]:
    """Start a node in the benchmark's own ROS domain."""
    options = [word for parameter in parameters for word in ('-p', parameter)]
    options += [word for remapping in remappings for word in ('-r', remapping)]
    return subprocess.Popen(
        [sys.executable, '-m', module, '--ros-args', *options],
        env=_own_domain(), start_new_session=True, stdout=subprocess.DEVNULL,
    )


def end_node(process: subprocess.Popen[bytes], timeout_s: float = _END_TIMEOUT_S) -> None:
    """Interrupt a node, or a loop of nodes, and wait; kill it after a time-out [s]."""
    end_process(process, timeout_s)


NODES = {
    'echo': 'contact_estimation.studies.echo_node',
    'estimator': 'contact_estimation.ros.estimator_node',
}
_PLANT = 'contact_estimation.ros.plant_node'
_SAMPLING_S = 0.05
_TIMEOUT_S = 60.0


def run_node_once(node: str, rate: float, seconds: float, parameters: list[str]) -> dict[str, Any]:
    """Run the plant with a node for some seconds at a rate [Hz]; measure load and latency."""
    with TemporaryDirectory() as folder:
        summary = Path(folder) / 'plant.json'
        under_test = start_node(NODES[node], [f'sample_rate:={rate:.1f}', *parameters])
        meters = {node: _meter(under_test), 'machine': CpuMeter(machine_cpu_s)}
        try:
            plant = start_node(_PLANT, [
                f'sample_rate:={rate:.1f}', f'duration:={seconds:.3f}', 'repeat:=true',
                'subscribers:=1', f'summary_file:={summary}',
            ])
            meters['plant'] = _meter(plant)
            try:
                _watch(node, under_test, plant, meters, seconds + _TIMEOUT_S)
            finally:
                end_node(plant)
        finally:
            end_node(under_test)
        return _figures(node, rate, json.loads(summary.read_text()), meters)


def _watch(
    node: str, under_test: subprocess.Popen[bytes], plant: subprocess.Popen[bytes],
    meters: Mapping[str, CpuMeter], timeout_s: float,
) -> None:
    deadline = time.monotonic() + timeout_s
    while plant.poll() is None:
        for meter in meters.values():
            meter.sample()
        if under_test.poll() is not None:
            raise ContactEstimationError(f'{node} ended early with {under_test.returncode}')
        if time.monotonic() > deadline:
            raise ContactEstimationError(f'plant_node did not end within {timeout_s:.0f} s')
        time.sleep(_SAMPLING_S)
    if plant.returncode:
        raise ContactEstimationError(f'plant_node ended with {plant.returncode}')


def _meter(process: subprocess.Popen[bytes]) -> CpuMeter:
    return CpuMeter(partial(process_cpu_s, process.pid))


def _figures(
    node: str, rate: float, summary: Mapping[str, Any], meters: Mapping[str, CpuMeter]
) -> dict[str, Any]:
    """Restrict the CPU load to the time of the samples, without start and end of the node."""
    sent, lost, latency = summary['samples_sent'], summary['samples_lost'], summary['latency_ms']
    if latency['p99'] is None:
        raise ContactEstimationError(
            f'{node} must publish a reference for each sample, but published none for {sent}')
    begin_ns = summary['begin_stamp_ns']
    end_ns = begin_ns + round(sent / rate * 1e9)
    shares = {name: meter.percent(begin_ns, end_ns) for name, meter in meters.items()}
    return {
        'node': node,
        'rate_hz': summary['rate_hz'],
        'cpu_percent': shares[node],
        'others_percent': shares['machine'] - shares[node] - shares['plant'],
        **{f'latency_ms_{name}': latency[name] for name in ('p50', 'p99', 'max')},
        'sent': sent,
        'lost': lost,
    }


_RATES = (500.0, 1000.0)


def run_node_benchmark(seconds: float, rounds: int, estimator: str) -> dict[str, Any]:
    """Alternate echo and estimator at each rate; seconds: duration of each run [s]."""
    own = {'echo': [], 'estimator': [f'estimator:={estimator}']}
    runs: list[dict[str, Any]] = []
    for rate in _RATES:
        for number in range(rounds):
            for node in NODES:
                figures = run_node_once(node, rate, seconds, own[node])
                runs.append({'rate': rate, 'round': number, **figures})
    ratios = [_ratios(rate, [run for run in runs if run['rate'] == rate]) for rate in _RATES]
    print_table(f'node: echo_node and estimator_node with {estimator}; CPU in % of one core', runs)
    print_table('node: ratios to echo_node of the same round, medians over rounds', ratios)
    return {'runs': runs, 'ratios': ratios}


def _ratios(rate: float, runs: list[dict[str, Any]]) -> dict[str, Any]:
    echoes = [run for run in runs if run['node'] == 'echo']
    estimators = [run for run in runs if run['node'] == 'estimator']

    def ratio(name: str) -> float:
        return median(b[name] / max(a[name], 1e-9) for a, b in zip(echoes, estimators))

    def dropped(runs: list[dict[str, Any]]) -> float:
        return sum(run['lost'] for run in runs) / sum(run['sent'] for run in runs)

    return {
        'rate': rate,
        'cpu_estimator/echo': ratio('cpu_percent'),
        'p50_estimator/echo': ratio('latency_ms_p50'),
        'p99_estimator/echo': ratio('latency_ms_p99'),
        'lost/sent_echo': dropped(echoes),
        'lost/sent_estimator': dropped(estimators),
    }


_NODE = 'estimator_node'
_LOOP_TIMEOUT_S = 100.0  # an interrupted loop waits for its three nodes and the view in turn


def run_watch_benchmark(seconds: float, rounds: int) -> dict[str, Any]:
    """Run `loop` and `loop --watch` for some seconds each in pairs of alternating order."""
    runs: list[dict[str, Any]] = []
    for number in range(rounds):
        for watched in (False, True) if number % 2 == 0 else (True, False):
            runs.append({'round': number, **_run_loop(watched, seconds)})
    loads = [[run['cpu_percent'] for run in runs if run['watched'] == watched]
             for watched in (True, False)]
    ratio = median(with_view / without for with_view, without in zip(*loads))
    print_table(f'watch: {_NODE} in the loop; CPU in % of one core', runs)
    print(f'CPU load of {_NODE} with the view, relative to that without: {ratio:.3f}')
    return {'runs': runs, 'ratio': ratio}


def _run_loop(watched: bool, seconds: float) -> dict[str, Any]:
    with TemporaryDirectory() as folder:
        output = Path(folder) / 'out'
        words = ['--output', str(output), '--duration', f'{seconds:.3f}']
        if watched:
            words += ['--watch', str(Path(folder) / 'view.rrd')]
        meter = _measured_loop(words, Path(folder) / 'errors.txt')
        summary = json.loads((output / 'plant_summary.json').read_text())
    begin_ns, latency = summary['begin_stamp_ns'], summary['latency_ms']
    return {
        'watched': watched,
        'cpu_percent': meter.percent(begin_ns, begin_ns + round(seconds * 1e9)),
        **{f'latency_ms_{name}': latency[name] for name in ('p50', 'p99', 'max')},
        'sent': summary['samples_sent'],
        'lost': summary['samples_lost'],
    }


def _measured_loop(words: list[str], errors: Path) -> CpuMeter:
    """Run `loop` to its end, and return the CPU time of its estimator node; raise if it fails."""
    with open(errors, 'wb') as stderr:
        loop = subprocess.Popen(
            [sys.executable, '-m', 'contact_estimation.commands.loop', *words],
            stdout=subprocess.DEVNULL, stderr=stderr, env=_own_domain(), start_new_session=True)
    meter: CpuMeter | None = None
    try:
        while loop.poll() is None:
            if meter is None:
                meter = next((CpuMeter(partial(process_cpu_s, pid))
                              for pid in _descendants(loop.pid) if _runs(pid, _NODE)), None)
            else:
                meter.sample()
            time.sleep(_SAMPLING_S)
    finally:
        end_node(loop, _LOOP_TIMEOUT_S)
    if loop.returncode or meter is None:
        raise ContactEstimationError(
            f'loop ended with {loop.returncode}: {errors.read_text().strip()}')
    return meter


def _descendants(pid: int) -> Iterator[int]:
    try:
        children = Path(f'/proc/{pid}/task/{pid}/children').read_text().split()
    except OSError:  # it has ended
        return
    for child in map(int, children):
        yield child
        yield from _descendants(child)


def _runs(pid: int, word: str) -> bool:
    """Return whether a word is an argument of a process."""
    try:
        return word.encode() in Path(f'/proc/{pid}/cmdline').read_bytes()
    except OSError:
        return False
