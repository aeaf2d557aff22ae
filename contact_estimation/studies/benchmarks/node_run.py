# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""One run of a node with the plant, each in its own process."""

from __future__ import annotations

from functools import partial
import json
from pathlib import Path
import subprocess
from tempfile import TemporaryDirectory
import time
from typing import Any, Mapping

from .cpu_meter import CpuMeter, machine_cpu_s, process_cpu_s
from .node_processes import end_node, start_node
from ...exceptions import ContactEstimationError

NODES = {
    'echo': 'contact_estimation.studies.benchmarks.echo_node',
    'estimator': 'contact_estimation.ros.estimator_node',
}
_PLANT = 'contact_estimation.ros.plant_node'
_SAMPLING_S = 0.05
_TIMEOUT_S = 60.0


def run_node_once(node: str, rate: float, seconds: float, parameters: list[str]) -> dict[str, Any]:
    """
    Run the plant with a node and measure load and latency.

    rate: sample rate [Hz]
    seconds: duration of the experiment [s]
    parameters: further parameters of the node, as NAME:=VALUE
    """
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
