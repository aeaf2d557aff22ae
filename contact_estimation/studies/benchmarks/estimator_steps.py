# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The timed functions of the estimator benchmark: each processes samples begin to end."""

from __future__ import annotations

from typing import Callable, Sequence

from filterpy.kalman import KalmanFilter
import numpy as np

from .contact_data import ContactData, estimator_rows, settled_pipeline
from .simulated_samples import RATE
from ...estimators import MULTIPLE_MODEL
from ...estimators.estimate import Frozen
from ...estimators.estimator import OnlineEstimator
from ...parameters.values import build
from ...pipeline.parameters import EstimationParameters
from ...pipeline.session import ContactSession
from ...reference.setpoints import Reference
from ...signals.contact_sample import ContactSample

Steps = Callable[[int, int], None]
_VARIANCE = 1.0 / 3.0  # of the simulated force noise [N^2]
_NOTHING_FROZEN = Frozen(False, False)


def pipeline_steps(data: ContactData, name: str) -> tuple[Steps, Steps]:
    """Prepare a pipeline as used by the node and by replay."""
    one = settled_pipeline(data, name).process
    run = settled_pipeline(data, name).process
    samples = [sample for sample, _ in data.samples]

    def one_by_one(begin: int, end: int) -> None:
        for sample, reference in data.samples[begin:end]:
            one((sample,), reference)

    def in_runs(begin: int, end: int) -> None:
        run(samples[begin:end], data.samples[begin][1])

    return one_by_one, in_runs


def session_steps(data: ContactData, name: str) -> Steps:
    """Prepare a whole session: synchroniser, pipeline and reference, message by message."""
    session = ContactSession(
        build(EstimationParameters, {'estimator': name, 'sample_rate': RATE}))

    def add(pairs: Sequence[tuple[ContactSample, Reference]]) -> None:
        for (stamp_ns, position, velocity, force), _ in pairs:
            session.add_motion(stamp_ns, position, velocity)
            session.add_wrench(stamp_ns, force)

    add(data.approach)
    return lambda begin, end: add(data.samples[begin:end])


def learning_steps(data: ContactData, name: str) -> tuple[Steps, Steps]:
    """Prepare a bare estimator with the rows that its pipeline passes to it, or the samples."""
    if name == MULTIPLE_MODEL:
        return _posterior_steps(data), _posterior_steps(data)
    rows = estimator_rows(data, name)
    one, run = (_estimator(data, name).update for _ in range(2))

    def one_by_one(begin: int, end: int) -> None:
        for row in rows[begin:end]:
            one((row,), _VARIANCE, _NOTHING_FROZEN)

    def in_runs(begin: int, end: int) -> None:
        run(rows[begin:end], _VARIANCE, _NOTHING_FROZEN)

    return one_by_one, in_runs


def _estimator(data: ContactData, name: str) -> OnlineEstimator:
    estimator = settled_pipeline(data, name).estimator
    assert estimator is not None
    return estimator


def _posterior_steps(data: ContactData) -> Steps:
    posterior = settled_pipeline(data, MULTIPLE_MODEL).posterior
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
    given = estimator_rows(data, 'indirect_adaptive')
    rows = [(row[0], np.array([row[1:4]])) for _, row in given]

    def steps(begin: int, end: int) -> None:
        for y, phi in rows[begin:end]:
            kalman.predict()
            kalman.update(y, R=_VARIANCE, H=phi)

    return steps
