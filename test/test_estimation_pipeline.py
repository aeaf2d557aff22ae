# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The pipeline: learns in contact alone, deterministic, changed live, conditions well."""

from typing import Any

from contact_estimation.estimators import ESTIMATORS
from contact_estimation.estimators.estimate import Estimate, EstimateStatus
from contact_estimation.parameters import changed
from contact_estimation.pipeline.axis_pipeline import EstimationPipeline
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples, estimates_of, PERIOD_NS, pipeline_with
import numpy as np
import pytest

BY_ESTIMATOR = pytest.mark.parametrize('estimator', ESTIMATORS)
PAIRS = list(zip(ESTIMATORS, (*list(ESTIMATORS)[1:], *ESTIMATORS)))
CONDITIONING = {'contact__force_noise': 0.2, 'contact__position_noise': 5e-5}


def free_flight(count: int, position: float = -0.05, level: float = 0.0) -> list[ContactSample]:
    """Rest away from the wall; `level` is the force that the sensor shows, with 0.5 N of noise."""
    noise = 0.5 * np.random.default_rng(12).standard_normal(count)
    return [
        ContactSample(k * PERIOD_NS, position, 0.0, level + error)
        for k, error in enumerate(noise.tolist())]


def later(samples: list[ContactSample], by_ns: int) -> list[ContactSample]:
    """Shift stamps."""
    return [sample._replace(stamp_ns=sample.stamp_ns + by_ns) for sample in samples]


def change(pipeline: EstimationPipeline, changes: dict[str, Any]) -> None:
    """Change parameters by their dotted names."""
    pipeline.configure(changed(pipeline.parameters, changes))


def known(estimate: Estimate) -> tuple[float, float]:
    """K_hat and B_hat."""
    return estimate.stiffness, estimate.damping


def spoiled(samples: list[ContactSample], seed: int) -> list[ContactSample]:
    """Return samples with wild values, lost ones, a noise burst, a flipped sign, two rates."""
    draw = np.random.default_rng(seed)
    stamps, *columns = np.array(samples).T
    x, _, force = columns
    count = len(stamps)
    for values, wrong in ((force, (30.0, -50.0, 1e6)), (x, (0.5, -0.01, 0.02))):
        values[draw.integers(0, count, 20)] += draw.choice(wrong, 20)
    force[1500:1700] += 8.0 * draw.standard_normal(200)
    force[2200:2300] *= -1.0
    kept = draw.uniform(size=count) > 0.01
    kept[800:830] = kept[2500::2] = False
    return [ContactSample(int(stamp), *row) for stamp, *row in np.array(
        [stamps, *columns]).T[kept].tolist()]


@pytest.mark.slow
@pytest.mark.parametrize('changes', [
    {}, {'environment__location': float('nan')}, {'physics__force_lag__tau': 2e-3},
    {'estimator': 'rls'}])
def test_samples_at_once_give_the_bits_of_samples_one_by_one(changes: dict[str, Any]) -> None:
    samples = contact_samples(1.5, force_noise=0.3)
    samples = [*samples, *later(samples, samples[-1].stamp_ns + PERIOD_NS)] * 2
    samples = [one._replace(stamp_ns=k * PERIOD_NS) for k, one in enumerate(samples)]
    samples = spoiled(samples, 0)
    together, found = pipeline_with(**changes), []
    draw = np.random.default_rng(0)
    rows = list(samples)
    while rows:
        size = int(draw.integers(1, 300))
        table, rows = np.array(rows[:size]), rows[size:]
        found += together.take_many(table[:, 0].astype(np.int64), *table.T[1:])
    assert repr(found) == repr(estimates_of(samples, pipeline_with(**changes)))
    assert any(one.status is EstimateStatus.ESTIMATING for one in found)


@BY_ESTIMATOR
def test_free_flight_neither_drifts_nor_jumps(estimator: str) -> None:
    pipeline = pipeline_with(estimator=estimator)
    learned = known(estimates_of(contact_samples(0.6, force_noise=0.3), pipeline)[-1])
    away = estimates_of(later(free_flight(2500), 2 * 10**9), pipeline)
    assert {known(estimate) for estimate in away} == {learned}


@pytest.mark.slow
def test_switch_of_estimator_keeps_stiffness_and_damping() -> None:
    for before, after in PAIRS:
        pipeline, samples = pipeline_with(estimator=before), contact_samples(0.5)
        learned = known(estimates_of(samples[:400], pipeline)[-1])
        change(pipeline, {'estimator': after})
        assert pipeline.estimator is not None, (before, after)
        assert (pipeline.estimator.stiffness, pipeline.estimator.damping) == learned, before


@BY_ESTIMATOR
def test_reset_goes_back_to_the_first_guess(estimator: str) -> None:
    pipeline = pipeline_with(estimator=estimator)
    estimates_of(contact_samples(0.5), pipeline)
    pipeline.reset()
    (estimate,) = estimates_of(later(free_flight(1), 5 * 10**9), pipeline)
    assert known(estimate) == (3000.0, 50.0)


def test_tare_removes_a_bias() -> None:
    pipeline = pipeline_with()
    estimates_of(free_flight(1000, level=3.0), pipeline)
    assert pipeline.tare()[0]
    assert pipeline.bias == pytest.approx(3.0, abs=0.1)


def test_tare_is_refused_in_contact() -> None:
    pipeline = pipeline_with()
    estimates_of(contact_samples(0.5), pipeline)
    done, message = pipeline.tare()
    assert (done, pipeline.bias) == (False, 0.0) and 'in contact' in message


def test_tare_survives_a_reset() -> None:
    pipeline = pipeline_with()
    estimates_of(free_flight(1000, level=3.0), pipeline)
    pipeline.tare()
    bias = pipeline.bias
    pipeline.reset()
    assert pipeline.bias == bias


def test_damping_is_held_where_the_contact_is_static() -> None:
    samples = contact_samples(1.5, amplitude=0.0, force_noise=0.3)
    last = estimates_of(samples, pipeline_with(estimator='rls'))[-1]
    assert last.reason == 'damping frozen: weak excitation'


@BY_ESTIMATOR
def test_dropout_in_contact_leaves_the_estimate_right(estimator: str) -> None:
    samples = contact_samples(2.0, with_velocity=False)
    kept = samples[:900] + samples[1000:]
    last = estimates_of(kept, pipeline_with(estimator=estimator))[-1]
    assert last.stiffness == pytest.approx(4800.0, rel=0.02)


@pytest.mark.slow
def test_damping_within_10_percent_from_noisy_positions_alone() -> None:
    samples = contact_samples(
        3.3, 5000.0, 40.0, force_noise=0.2, position_noise=5e-5, with_velocity=False, seed=1)
    for estimator in ESTIMATORS:
        last = estimates_of(samples, pipeline_with(estimator=estimator, **CONDITIONING))[-1]
        assert last.stiffness == pytest.approx(5000.0, rel=0.02), estimator
        assert last.damping == pytest.approx(40.0, rel=0.1), estimator


def test_refused_parameters_change_nothing() -> None:
    pipeline = pipeline_with()
    before = pipeline.parameters
    with pytest.raises(ValueError, match='cutoff_frequency'):
        change(pipeline, {'conditioning.cutoff_frequency': 250.0})
    assert pipeline.parameters is before
