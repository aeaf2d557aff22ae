# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimator node against an echo node on the same topics."""

from __future__ import annotations

from statistics import median
from typing import Any

from .node_run import NODES, run_node_once
from .table import print_table

_RATES = (500.0, 1000.0)


def run_node_benchmark(seconds: float, rounds: int, estimator: str) -> dict[str, Any]:
    """
    Alternate echo and estimator at each rate.

    seconds: duration of each run [s]
    """
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
