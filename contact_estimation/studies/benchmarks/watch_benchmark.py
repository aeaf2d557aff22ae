# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimator node of the loop with a live view and without."""

from __future__ import annotations

from functools import partial
import json
from pathlib import Path
from statistics import median
import subprocess
import sys
from tempfile import TemporaryDirectory
import time
from typing import Any, Iterator

from .measuring import CpuMeter, print_table, process_cpu_s
from .node_benchmark import end_node, own_domain
from ...exceptions import ContactEstimationError

_NODE = 'estimator_node'
_SAMPLING_S = 0.05
_LOOP_TIMEOUT_S = 100.0  # an interrupted loop waits for its three nodes and the view in turn


def run_watch_benchmark(seconds: float, rounds: int) -> dict[str, Any]:
    """
    Run `loop` and `loop --watch` in pairs, whose order alternates.

    seconds: duration of each run [s]
    """
    runs: list[dict[str, Any]] = []
    for number in range(rounds):
        for watched in (False, True) if number % 2 == 0 else (True, False):
            runs.append({'round': number, **_run_once(watched, seconds)})
    loads = [[run['cpu_percent'] for run in runs if run['watched'] == watched]
             for watched in (True, False)]
    ratio = median(with_view / without for with_view, without in zip(*loads))
    print_table(f'watch: {_NODE} in the loop; CPU in % of one core', runs)
    print(f'CPU load of {_NODE} with the view, relative to that without: {ratio:.3f}')
    return {'runs': runs, 'ratio': ratio}


def _run_once(watched: bool, seconds: float) -> dict[str, Any]:
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
            stdout=subprocess.DEVNULL, stderr=stderr, env=own_domain(), start_new_session=True)
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
