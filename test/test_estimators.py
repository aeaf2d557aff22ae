# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What every registered estimator owes: registering a variant tests it."""

from __future__ import annotations

from math import isfinite
from typing import Any

from contact_estimation.estimators import ESTIMATORS
from contact_estimation.estimators.estimate import EstimateStatus
from contact_estimation.estimators.parameters import EnvironmentParameters
from contact_estimation.parameters import specifications
from core_runs import closed_loop, contact_samples, estimates_of, PAPER_SENSORS, pipeline_with
import numpy as np
import pytest

EACH = pytest.mark.parametrize('name', ESTIMATORS)
SAMPLES = contact_samples(2.5, force_noise=0.3)


@pytest.fixture(scope='module', params=ESTIMATORS)
def estimates(request: pytest.FixtureRequest) -> Any:
    return estimates_of(SAMPLES, pipeline_with(estimator=request.param))


def test_sine_contact_gives_the_stiffness(estimates: Any) -> None:
    assert estimates[-1].stiffness == pytest.approx(4800.0, rel=0.02)


def test_sine_contact_gives_the_damping(estimates: Any) -> None:
    assert estimates[-1].damping == pytest.approx(200.0, rel=0.06)


def test_status_is_free_before_contact(estimates: Any) -> None:
    before = [e for e, s in zip(estimates, SAMPLES) if s.position < 0.0]
    assert {e.status for e in before} == {EstimateStatus.FREE}


def test_claimed_std_is_never_negative_nor_infinite(estimates: Any) -> None:
    claimed = np.array([e[3:5] for e in estimates])
    claimed = claimed[~np.isnan(claimed)]  # nothing is claimed before a row was learned
    assert len(claimed) > len(estimates)
    assert np.all(claimed >= 0.0) and np.all(np.isfinite(claimed))


def test_stiffness_damping_and_location_are_always_finite(estimates: Any) -> None:
    assert all(isfinite(v) for e in estimates for v in (e.stiffness, e.damping, e.location))


@pytest.mark.slow
@EACH
def test_paper_s_loop_ends_within_the_paper_s_errors(name: str) -> None:
    last = closed_loop({'estimator': name}, PAPER_SENSORS).last
    rtol = 0.1 if name == 'hunt_crossley' else 0.03  # whose law is another
    np.testing.assert_allclose([last.stiffness, last.damping], [4800.0, 200.0], rtol=rtol)


@EACH
def test_tuning_says_what_every_parameter_means(name: str) -> None:
    assert all(len(s.description) > 8 for s in specifications(ESTIMATORS[name].Parameters))


@EACH
def test_tuning_bounds_every_number(name: str) -> None:
    numbers = [s for s in specifications(ESTIMATORS[name].Parameters)
               if type(s.default) in (int, float)]
    assert all(s.minimum is not None for s in numbers)


@EACH
def test_start_from_begins_at_the_given_values(name: str) -> None:
    cls = ESTIMATORS[name]
    estimator = cls(cls.Parameters(), EnvironmentParameters(), 0.002)
    estimator.start_from(7000.0, 80.0)
    assert (estimator.stiffness, estimator.damping) == (7000.0, 80.0)


@pytest.mark.slow
def test_other_sample_rates_give_the_stiffness_too() -> None:
    for name in ESTIMATORS:
        for rate in [125.0, 1000.0]:
            pipeline = pipeline_with(estimator=name, sample_rate=rate)
            last = estimates_of(contact_samples(2.0, rate=rate), pipeline)[-1]
            assert last.stiffness == pytest.approx(4800.0, rel=0.03), (name, rate)
