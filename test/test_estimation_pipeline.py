# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The pipeline: learns in contact alone, deterministic, changed live, conditions well."""

from __future__ import annotations

from itertools import permutations
from typing import Any

from contact_estimation.estimators import ESTIMATORS
from contact_estimation.estimators.estimate import Estimate, EstimateStatus
from contact_estimation.parameters.values import build, changed
from contact_estimation.pipeline.axis_pipeline import EstimationPipeline
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import (
    closed_loop,
    contact_samples,
    estimates_of,
    PAPER_SENSORS,
    PERIOD_NS,
    pipeline_with,
)
import numpy as np
import pytest

BY_ESTIMATOR = pytest.mark.parametrize('estimator', ESTIMATORS)
PAIRS = list(permutations(ESTIMATORS, 2))
CONDITIONING = {'contact__force_noise': 0.2, 'contact__position_noise': 5e-5}


def free_flight(count: int, position: float = -0.05, level: float = 0.0) -> list[ContactSample]:
    """Rest away from the wall; `level` is the force that the sensor shows, with 0.5 N of noise."""
    noise = 0.5 * np.random.default_rng(12).standard_normal(count)
    return [
        ContactSample(k * PERIOD_NS, position, 0.0, level + error)
        for k, error in enumerate(noise.tolist())
    ]


def later(samples: list[ContactSample], by_ns: int) -> list[ContactSample]:
    """Shift stamps."""
    return [sample._replace(stamp_ns=sample.stamp_ns + by_ns) for sample in samples]


def change(pipeline: EstimationPipeline, changes: dict[str, Any]) -> None:
    """Change parameters by their dotted names."""
    pipeline.configure(changed(pipeline.parameters, changes))


def known(estimate: Estimate) -> tuple[float, float]:
    """K_hat and B_hat."""
    return estimate.stiffness, estimate.damping


@BY_ESTIMATOR
def test_estimates_depend_on_the_samples_alone(estimator: str) -> None:
    samples = contact_samples(0.4, force_noise=0.5)
    runs = [repr(estimates_of(samples, pipeline_with(estimator=estimator))) for _ in range(2)]
    assert runs[0] == runs[1]


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


@pytest.mark.parametrize('changes', [
    {}, {'environment__location': float('nan')}, {'physics__force_lag__tau': 2e-3},
    {'estimator': 'rls'}])
@pytest.mark.parametrize('seed', [0, 1])
def test_samples_at_once_give_the_bits_of_samples_one_by_one(
    changes: dict[str, Any], seed: int
) -> None:
    samples = contact_samples(1.5, force_noise=0.3)
    samples = [*samples, *later(samples, samples[-1].stamp_ns + PERIOD_NS)] * 2
    samples = [one._replace(stamp_ns=k * PERIOD_NS) for k, one in enumerate(samples)]
    samples = spoiled(samples, seed)
    together, found = pipeline_with(**changes), []
    draw = np.random.default_rng(seed)
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


@BY_ESTIMATOR
@pytest.mark.parametrize('bias', [-5.0, 5.0])
def test_force_bias_far_from_the_wall_is_no_contact(estimator: str, bias: float) -> None:
    pipeline = pipeline_with(estimator=estimator)
    statuses = {e.status for e in estimates_of(free_flight(1000, level=bias), pipeline)}
    assert statuses == {EstimateStatus.FREE}


@BY_ESTIMATOR
def test_force_bias_is_not_learned_as_stiffness_after_tare(estimator: str) -> None:
    pipeline = pipeline_with(estimator=estimator)
    estimates_of(free_flight(1000, level=1.0), pipeline)
    pipeline.tare()
    samples = [s._replace(force=s.force + 1.0) for s in contact_samples(1.0)]
    last = estimates_of(later(samples, 3 * 10**9), pipeline)[-1]
    assert last.stiffness == pytest.approx(4800.0, rel=0.01)


@pytest.mark.parametrize('before, after', PAIRS)
def test_switch_of_estimator_keeps_stiffness_and_damping(before: str, after: str) -> None:
    pipeline, samples = pipeline_with(estimator=before), contact_samples(0.5)
    learned = known(estimates_of(samples[:400], pipeline)[-1])
    change(pipeline, {'estimator': after})
    assert pipeline.estimator is not None
    assert (pipeline.estimator.stiffness, pipeline.estimator.damping) == learned


@pytest.mark.parametrize('before, after', PAIRS)
def test_learning_goes_on_smoothly_after_a_switch(before: str, after: str) -> None:
    pipeline, samples = pipeline_with(estimator=before), contact_samples(1.6)
    estimates_of(samples[:800], pipeline)
    change(pipeline, {'estimator': after})
    stiffness = [e.stiffness for e in estimates_of(samples[800:], pipeline)]
    np.testing.assert_allclose(stiffness, 4800.0, rtol=0.05)


@BY_ESTIMATOR
def test_limit_given_in_contact_holds_from_then_on(estimator: str) -> None:
    pipeline, samples = pipeline_with(estimator=estimator), contact_samples(0.8)
    estimates_of(samples[:400], pipeline)
    change(pipeline, {'environment.maximum_stiffness': 3500.0})
    assert max(e.stiffness for e in estimates_of(samples[400:], pipeline)) <= 3500.0


@BY_ESTIMATOR
def test_reset_goes_back_to_the_first_guess(estimator: str) -> None:
    pipeline = pipeline_with(estimator=estimator)
    estimates_of(contact_samples(0.5), pipeline)
    pipeline.reset()
    (estimate,) = estimates_of(later(free_flight(1), 5 * 10**9), pipeline)
    assert known(estimate) == (3000.0, 50.0)


@BY_ESTIMATOR
def test_restart_of_time_keeps_what_was_learned(estimator: str) -> None:
    pipeline, samples = pipeline_with(estimator=estimator), contact_samples(1.0)
    learned = known(estimates_of(samples, pipeline)[-1])
    pipeline.restart_time()
    again = estimates_of(samples[:50], pipeline)
    assert {known(estimate) for estimate in again} == {learned}


@BY_ESTIMATOR
def test_second_pass_after_a_restart_of_time_stays_at_the_truth(estimator: str) -> None:
    pipeline, samples = pipeline_with(estimator=estimator), contact_samples(1.6)
    estimates_of(samples, pipeline)
    pipeline.restart_time()
    stiffness = [e.stiffness for e in estimates_of(samples, pipeline)]
    np.testing.assert_allclose(stiffness, 4800.0, rtol=0.05)


def test_tare_removes_a_bias() -> None:
    pipeline = pipeline_with()
    estimates_of(free_flight(1000, level=3.0), pipeline)
    assert pipeline.tare()[0]
    assert pipeline.bias == pytest.approx(3.0, abs=0.1)


def test_second_tare_adds_to_the_first() -> None:
    pipeline = pipeline_with()
    for k in range(2):
        estimates_of(later(free_flight(1000, level=3.0 + k), k * 2 * 10**9), pipeline)
        pipeline.tare()
    assert pipeline.bias == pytest.approx(4.0, abs=0.1)


def test_tare_is_refused_in_contact() -> None:
    pipeline = pipeline_with()
    estimates_of(contact_samples(0.5), pipeline)
    done, message = pipeline.tare()
    assert (done, pipeline.bias) == (False, 0.0) and 'in contact' in message


def test_tare_is_refused_before_any_sample() -> None:
    assert pipeline_with().tare()[0] is False


def test_tare_is_refused_too_soon_after_contact() -> None:
    pipeline = pipeline_with()
    estimates_of(free_flight(200), pipeline)  # 0.4 s
    done, message = pipeline.tare()
    assert not done and '0.5 s' in message


def test_tare_removes_a_bias_where_the_surface_is_to_be_taken_at_first_touch() -> None:
    pipeline = pipeline_with(environment__location=np.nan)
    estimates_of(free_flight(1000, level=1.0), pipeline)
    assert pipeline.tare()[0]
    assert pipeline.bias == pytest.approx(1.0, abs=0.1)


def test_tare_inside_the_wall_is_refused_with_the_reason() -> None:
    pipeline = pipeline_with()
    estimates_of(free_flight(1000, position=0.03), pipeline)
    done, message = pipeline.tare()
    assert not done and '30 mm inside environment.location' in message


def test_tare_survives_a_reset() -> None:
    pipeline = pipeline_with()
    estimates_of(free_flight(1000, level=3.0), pipeline)
    pipeline.tare()
    bias = pipeline.bias
    pipeline.reset()
    assert pipeline.bias == bias


def test_noise_is_learned_in_free_flight() -> None:
    pipeline = pipeline_with()
    estimates_of(free_flight(4000), pipeline)
    assert pipeline.noise_std == pytest.approx(0.5, rel=0.15)


def test_damping_is_held_where_the_contact_is_static() -> None:
    samples = contact_samples(1.5, amplitude=0.0, force_noise=0.3)
    last = estimates_of(samples, pipeline_with(estimator='rls'))[-1]
    assert last.reason == 'damping frozen: weak excitation'


def test_nothing_is_held_with_the_sine() -> None:
    last = estimates_of(contact_samples(1.5, force_noise=0.3), pipeline_with())[-1]
    assert (last.status, last.reason) == (EstimateStatus.ESTIMATING, '')


def test_known_friction_is_taken_out_of_the_force() -> None:
    pipeline = pipeline_with(physics__coulomb_friction__F_c=6.0, estimator='kalman')
    samples = [
        s._replace(force=min(0.0, s.force - 6.0 * np.tanh(s.velocity / 4e-4)) if s.force else 0.0)
        for s in contact_samples(1.5)
    ]
    np.testing.assert_allclose(known(estimates_of(samples, pipeline)[-1]), [4800, 200], rtol=0.02)


def test_missing_samples_in_contact_freeze_and_then_learning_goes_on() -> None:
    samples = contact_samples(1.0)
    kept = samples[:500] + samples[520:]
    estimates = estimates_of(kept, pipeline_with(estimator='rls'))
    assert 'consecutive' in estimates[500].reason
    assert estimates[-1].status is EstimateStatus.ESTIMATING


@BY_ESTIMATOR
def test_dropout_in_contact_leaves_the_estimate_right(estimator: str) -> None:
    samples = contact_samples(2.0, with_velocity=False)
    kept = samples[:900] + samples[1000:]
    last = estimates_of(kept, pipeline_with(estimator=estimator))[-1]
    assert last.stiffness == pytest.approx(4800.0, rel=0.02)


@pytest.mark.slow
@BY_ESTIMATOR
@pytest.mark.parametrize('seed', [1, 2, 3])
def test_damping_within_10_percent_from_noisy_positions_alone(estimator: str, seed: int) -> None:
    pipeline = pipeline_with(estimator=estimator, **CONDITIONING)
    samples = contact_samples(
        3.3, 5000.0, 40.0, force_noise=0.2, position_noise=5e-5, with_velocity=False, seed=seed
    )
    assert estimates_of(samples, pipeline)[-1].damping == pytest.approx(40.0, rel=0.1)


@BY_ESTIMATOR
def test_stiffness_within_2_percent_from_noisy_positions_alone(estimator: str) -> None:
    pipeline = pipeline_with(estimator=estimator, **CONDITIONING)
    samples = contact_samples(
        3.3, 5000.0, 40.0, force_noise=0.2, position_noise=5e-5, with_velocity=False
    )
    assert estimates_of(samples, pipeline)[-1].stiffness == pytest.approx(5000.0, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize('estimator', ['kalman', 'rls', 'indirect_adaptive'])
def test_stiff_wall_is_found_within_3_seconds(estimator: str) -> None:
    estimation = {'estimator': estimator, 'tuning.indirect_adaptive.normalised': True}
    run = closed_loop(estimation, {**PAPER_SENSORS, 'environment.stiffness': 1e5}, duration=9.0)
    begin = next(t.t for t in run.truths if t.force < 0.0)
    at = next(r for t, r in zip(run.truths, run.results) if t.t >= begin + 3.0)
    assert at.estimate.stiffness == pytest.approx(1e5, rel=0.05)


def test_refused_parameters_change_nothing() -> None:
    pipeline = pipeline_with()
    before = pipeline.parameters
    with pytest.raises(ValueError, match='cutoff_frequency'):
        change(pipeline, {'conditioning.cutoff_frequency': 250.0})
    assert pipeline.parameters is before


@BY_ESTIMATOR
@pytest.mark.parametrize('cut', [1, 7, 64, 10_000])
def test_estimates_do_not_depend_on_how_samples_are_cut_into_runs(
    estimator: str, cut: int
) -> None:
    samples = contact_samples(0.5, force_noise=0.5, with_velocity=False)
    pipeline: Any = pipeline_with(estimator=estimator)
    runs = [pipeline.process(samples[k:k + cut]) for k in range(0, len(samples), cut)]
    expected = estimates_of(samples, pipeline_with(estimator=estimator))
    assert repr([e for run in runs for e in run]) == repr(expected)


def test_pipeline_without_parameters_takes_the_defaults() -> None:
    assert EstimationPipeline().parameters == build(EstimationParameters, {})
