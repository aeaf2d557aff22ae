# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Time of one update: session and bare estimator, against filterpy's Kalman filter."""

from __future__ import annotations

import gc
from math import pi
from statistics import mean, median
import time
from typing import Any, Callable, NamedTuple, Sequence

from filterpy.kalman import KalmanFilter
import numpy as np

from .measuring import print_table
from ..estimators import MULTIPLE_MODEL, ONLINE_ESTIMATORS
from ..estimators.estimate import Frozen
from ..estimators.estimator import TimedRow
from ..parameters import build
from ..pipeline.axes import Result
from ..pipeline.axis_pipeline import EstimationPipeline
from ..pipeline.parameters import EstimationParameters
from ..pipeline.session import ContactSession
from ..plant.closed_loop import run_closed_loop
from ..plant.plant_parameters import PAPER_NOISE, PlantParameters
from ..reference.experiment import Experiment, Sine
from ..reference.experiments import manoeuvre
from ..reference.setpoints import Reference
from ..signals.contact_sample import ContactSample

RATE = 500.0
_SETTLED_S = 8.6  # two seconds into the hold

Steps = Callable[[int, int], None]
"""Passes samples from one number to another."""


def simulated(experiment: Experiment, duration: float) -> list[Result]:
    """Simulate an experiment with the paper's noise."""
    session = ContactSession(build(EstimationParameters, {'sample_rate': RATE}))
    return run_closed_loop(build(PlantParameters, PAPER_NOISE), session, experiment,
                           duration).results


def pressing(seconds: float) -> tuple[list[Result], list[Result]]:
    """Simulate an approach, and a contact of some seconds with 3 Hz excitation."""
    experiment = manoeuvre('pressing', Sine(8.0, 6.0 * pi), hold_s=seconds + 3.0)
    results = simulated(experiment, _SETTLED_S + seconds)
    begin = round(_SETTLED_S * RATE)
    return results[:begin], results[begin:]


class ContactData(NamedTuple):
    """Samples, each with the reference that the robot followed."""

    approach: list[tuple[ContactSample, Reference]]  # in free flight, before the contact
    samples: list[tuple[ContactSample, Reference]]  # in contact


def contact_data(seconds: float) -> ContactData:
    """Simulate an approach and a contact of a duration [s] at 500 Hz."""
    approach, pressed = pressing(seconds)
    results = [*approach, *pressed]
    pairs = [(now.sample, before.reference) for before, now in zip(results, results[1:])
             if before.reference is not None]
    return ContactData(pairs[:len(approach)], pairs[len(approach):])


def _settled_pipeline(data: ContactData, name: str) -> EstimationPipeline:
    """Build a pipeline that has processed the approach."""
    pipeline = EstimationPipeline(
        build(EstimationParameters, {'estimator': name, 'sample_rate': RATE}))
    for sample, reference in data.approach:
        pipeline.process((sample,), reference)
    return pipeline


def _estimator_rows(data: ContactData, name: str) -> list[TimedRow]:
    """Collect the rows that a pipeline passes to an estimator that runs on rows."""
    pipeline = _settled_pipeline(data, name)
    rows: list[TimedRow] = []
    assert pipeline.estimator is not None
    update = pipeline.estimator.update

    def record(part: Sequence[TimedRow], variance: float, frozen: Frozen) -> list[Any]:
        rows.extend(part)
        return update(part, variance, frozen)

    setattr(pipeline.estimator, 'update', record)
    for sample, reference in data.samples:
        pipeline.take(sample, reference)
    return rows


_VARIANCE = 1.0 / 3.0  # of the simulated force noise [N^2]
_NOTHING_FROZEN = Frozen(False, False)


def _session_steps(data: ContactData, name: str) -> Steps:
    """Prepare a whole session: synchroniser, pipeline and reference, message by message."""
    session = ContactSession(build(EstimationParameters, {'estimator': name, 'sample_rate': RATE}))

    def add(pairs: Sequence[tuple[ContactSample, Reference]]) -> None:
        for (stamp_ns, position, velocity, force), _ in pairs:
            session.add_motion(stamp_ns, position, velocity)
            session.add_wrench(stamp_ns, force)

    add(data.approach)
    return lambda begin, end: add(data.samples[begin:end])


def _update_steps(data: ContactData, name: str) -> tuple[Steps, Steps]:
    """Prepare a bare estimator, row by row and many rows a call, as in replay."""
    if name == MULTIPLE_MODEL:
        return _posterior_steps(data), _posterior_steps(data)
    rows, updates = _estimator_rows(data, name), []
    for _ in range(2):
        estimator = _settled_pipeline(data, name).estimator
        assert estimator is not None
        updates.append(estimator.update)

    def one_by_one(begin: int, end: int) -> None:
        for row in rows[begin:end]:
            updates[0]((row,), _VARIANCE, _NOTHING_FROZEN)

    def in_runs(begin: int, end: int) -> None:
        updates[1](rows[begin:end], _VARIANCE, _NOTHING_FROZEN)

    return one_by_one, in_runs


def _posterior_steps(data: ContactData) -> Steps:
    posterior = _settled_pipeline(data, MULTIPLE_MODEL).posterior
    posterior.restart()  # its time began with the approach
    samples = [(1e-9 * stamp_ns, -force, x, v) for (stamp_ns, x, v, force), _ in data.samples]

    def steps(begin: int, end: int) -> None:
        for sample in samples[begin:end]:
            posterior.take(*sample)

    return steps


def filterpy_step(data: ContactData) -> Steps:
    """Prepare filterpy's Kalman filter for (K_e, B_e, c) with one scalar force per step."""
    kalman = KalmanFilter(dim_x=3, dim_z=1)
    kalman.x = np.array([[3000.0], [50.0], [0.0]])
    kalman.P = np.diag([1e6, 1e4, 1.0])
    kalman.Q = np.diag([1.0, 0.1, 1e-6])
    rows = [(row[0], np.array([row[1:4]])) for _, row in _estimator_rows(
        data, 'indirect_adaptive')]

    def steps(begin: int, end: int) -> None:
        for y, phi in rows[begin:end]:
            kalman.predict()
            kalman.update(y, R=_VARIANCE, H=phi)

    return steps


_BLOCK = 250  # samples; short, so that all candidates see the same load of the machine
_SESSION = 'session_us'
_FILTERPY = 'filterpy KalmanFilter'
_FIGURES = ('session_us', 'session_p999_us', 'update_us', 'update_run_us')


def run_estimator_benchmark(seconds: float) -> dict[str, Any]:
    """
    Time all candidates on the same samples, alternating block by block.

    seconds: duration of the contact [s]
    Returns results: `estimators`, one entry each: CPU time per sample [us] (of the session the
    mean and the 99.9 % quantile of single samples, else medians over the blocks) and their ratios
    to filterpy's predict and update. `run`: many samples per call, as in replay.
    """
    data = contact_data(seconds)
    candidates: dict[str, Steps] = {_FILTERPY: filterpy_step(data)}
    for name in ONLINE_ESTIMATORS:
        candidates[f'{name} {_SESSION}'] = _session_steps(data, name)
        candidates[f'{name} update_us'], candidates[f'{name} update_run_us'] = _update_steps(
            data, name)
    spent = _alternate(candidates, len(data.samples))
    rows = [_row(name, spent) for name in ONLINE_ESTIMATORS]
    rows.append({**dict.fromkeys(rows[0]), 'estimator': _FILTERPY, 'update_us': spent[_FILTERPY],
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
            spent[name] += [_timed(steps, k, k + size) for k in range(begin, begin + _BLOCK, size)]
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


def _row(name: str, spent: dict[str, float]) -> dict[str, Any]:
    times = {figure: spent[f'{name} {figure}'] for figure in _FIGURES}
    ratios = {f'{figure[:-3]}/filterpy': time / spent[_FILTERPY] for figure, time in times.items()}
    return {'estimator': name, **times, **ratios}
