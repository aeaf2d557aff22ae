# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Time of one update: session, pipeline and bare estimator, against filterpy's Kalman filter."""

from __future__ import annotations

import gc
from statistics import mean, median
import time
from typing import Any

import numpy as np

from .contact_data import contact_data, learning_share
from .estimator_steps import filterpy_step, learning_steps, pipeline_steps, session_steps, Steps
from .table import print_table
from ...estimators import ONLINE_ESTIMATORS

_BLOCK = 250  # samples; short, so that all candidates see the same load of the machine
_SESSION = 'session_us'
FILTERPY = 'filterpy KalmanFilter'
_FIGURES = ('session_us', 'session_p999_us', 'pipeline_us', 'pipeline_run_us', 'update_us',
            'update_run_us')


def run_estimator_benchmark(seconds: float) -> dict[str, Any]:
    """
    Time all candidates on the same samples, alternating block by block.

    seconds: duration of the contact [s]
    Returns results: `estimators`, one entry each: CPU time per sample [us] (of the session the
    mean and the 99.9 % quantile of single samples, else medians over the blocks) and their ratios
    to filterpy's predict and update. `run`: many samples per call, as in replay.
    """
    data = contact_data(seconds)
    candidates: dict[str, Steps] = {FILTERPY: filterpy_step(data)}
    for name in ONLINE_ESTIMATORS:
        candidates[f'{name} {_SESSION}'] = session_steps(data, name)
        for part, prepare in (('pipeline', pipeline_steps), ('update', learning_steps)):
            one_by_one, in_runs = prepare(data, name)
            candidates[f'{name} {part}_us'] = one_by_one
            candidates[f'{name} {part}_run_us'] = in_runs
    spent = _alternate(candidates, len(data.samples))
    rows = [_row(name, spent, learning_share(data, name)) for name in ONLINE_ESTIMATORS]
    rows.append({**dict.fromkeys(rows[0]), 'estimator': FILTERPY, 'update_us': spent[FILTERPY],
                 'update/filterpy': 1.0})
    print_table('estimators in contact: us per sample, ratios to filterpy predict + update (3x1)',
                rows)
    return {'estimators': rows}


def _alternate(candidates: dict[str, Steps], count: int) -> dict[str, float]:
    spent: dict[str, list[float]] = {name: [] for name in candidates}
    gc.collect()
    gc.freeze()  # as the node does
    for begin in range(0, count - _BLOCK + 1, _BLOCK):
        for name, steps in candidates.items():
            size = 1 if name.endswith(_SESSION) else _BLOCK
            spent[name] += [_timed(steps, k, k + size)
                            for k in range(begin, begin + _BLOCK, size)]
    gc.unfreeze()
    figures: dict[str, float] = {}
    for name, times in spent.items():
        if name.endswith(_SESSION):  # the first block of each is warm-up
            figures[name] = mean(times[_BLOCK:])
            figures[name.replace(_SESSION, 'session_p999_us')] = float(
                np.quantile(times[_BLOCK:], 0.999))
        else:
            figures[name] = median(times[1:])
    return figures


def _timed(steps: Steps, begin: int, end: int) -> float:
    start = time.thread_time_ns()
    steps(begin, end)
    return (time.thread_time_ns() - start) * 1e-3 / (end - begin)


def _row(name: str, spent: dict[str, float], share: float) -> dict[str, Any]:
    times = {figure: spent[f'{name} {figure}'] for figure in _FIGURES}
    ratios = {f'{figure[:-3]}/filterpy': time / spent[FILTERPY] for figure, time in times.items()}
    return {'estimator': name, **times, **ratios, 'learning_share': share}
