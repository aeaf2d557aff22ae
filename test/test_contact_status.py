# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What the status of an estimate says before, in and after a contact."""

from __future__ import annotations

from functools import lru_cache
from math import nan

from contact_estimation.estimation.parameters import EstimationParameters
from contact_estimation.estimation.pipeline import EstimationPipeline
from contact_estimation.estimators.estimate import Estimate, EstimateStatus
from contact_estimation.parameters.values import changed
from contact_estimation.signals.contact_sample import ContactSample
import numpy as np
import pytest
from wall_worlds import contact, Samples, spring_damper

K, B = 5000.0, 100.0
FREE, ESTIMATING, FROZEN = (
    EstimateStatus.FREE, EstimateStatus.ESTIMATING, EstimateStatus.FROZEN)
ESTIMATORS = ['multiple_model', 'kalman', 'rls', 'hunt_crossley']


@lru_cache
def two_presses() -> Samples:
    return contact(spring_damper(K, B), 4.2, presses=((0.5, 2.0), (2.5, 4.0)))


def estimates_of(samples: Samples, **changes: object) -> list[Estimate]:
    pipeline = EstimationPipeline(changed(EstimationParameters(), changes))
    return [pipeline.take(ContactSample(10**18 + round(t * 1e9), x, nan, -force))
            for t, force, x, _ in zip(*(one.tolist() for one in samples))]


@pytest.mark.parametrize('estimator', ESTIMATORS)
def test_status_is_free_outside_the_wall_and_not_while_it_presses(estimator: str) -> None:
    samples = two_presses()
    statuses = np.array([one.status.value for one in estimates_of(samples, estimator=estimator)])
    pressing = K * samples.depth
    assert set(statuses[(samples.depth < 0.0) & (samples.t < 0.6)]) == {'free'}
    assert 'free' not in statuses[pressing > 10.0]
    between = (samples.t > 2.05) & (samples.t < 2.5)
    assert set(statuses[between]) == {'free'}
    assert statuses[-1] == 'free'


@pytest.mark.parametrize('estimator', ESTIMATORS)
def test_estimates_out_of_contact_are_those_of_the_contact_before(estimator: str) -> None:
    samples = two_presses()
    estimates = estimates_of(samples, estimator=estimator)
    held = {(one.stiffness, one.damping) for one, t in zip(estimates, samples.t)
            if 2.1 < t < 2.5}
    assert len(held) == 1
    assert held.pop()[0] == pytest.approx(K, rel=0.02)


def test_pull_is_no_contact_and_says_so() -> None:
    samples = two_presses()
    pulled = samples._replace(force=np.where(samples.t > 0.3, -20.0, samples.force),
                              x=samples.x - 0.1)
    estimates = estimates_of(pulled)
    first = [one for one, t in zip(estimates, samples.t) if 0.32 < t < 0.5]
    assert {one.status for one in first} == {FREE}
    assert all(one.reason for one in first)
