# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The status of the contact, and latched steps."""

from functools import lru_cache
from math import inf, nan

from contact_estimation.estimators.estimate import (
    Estimate, EstimateStatus, ParameterEstimate)
from contact_estimation.estimators.multiple_model import LAWS
from contact_estimation.estimators.rls import RecursiveLeastSquares
from contact_estimation.exceptions import RecordingError
from contact_estimation.parameters import build, changed, flatten
from contact_estimation.pipeline.axes import Moment
from contact_estimation.pipeline.axis_pipeline import EstimationPipeline
from contact_estimation.pipeline.events import (
    apply_event, CHANGE, EstimationEvent, event_now, RESET, START, TARE)
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.pipeline.wall_law import laws_in_words, WallLawNews
from contact_estimation.signals.contact_sample import ContactSample
from core_runs import contact_samples, pipeline_with
from hypothesis import given, Phase, settings, strategies as st
import numpy as np
from numpy.typing import NDArray
import pytest
from wall_worlds import Array, contact, Samples, spring_damper

K, B = 5000.0, 100.0
FREE, ESTIMATING, FROZEN = (EstimateStatus.FREE, EstimateStatus.ESTIMATING, EstimateStatus.FROZEN)
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
    held = {(one.stiffness, one.damping) for one, t in zip(estimates, samples.t) if 2.1 < t < 2.5}
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


def test_an_estimate_that_the_last_contact_left_without_band_says_so() -> None:
    samples = two_presses()
    later = samples.t - 3.0
    share = np.where(later > 0.0, 1.0 + 0.8 * np.sin(30.0 * later), 1.0)
    known, *_, lost = estimates_of(samples._replace(force=samples.force * share))[int(
        np.searchsorted(samples.t, 3.0)):]
    assert (known.stiffness_std < 0.01 * K, known.reason) == (True, '')
    assert lost.status is FREE and lost.stiffness_std != lost.stiffness_std
    assert 'the stiffness has no band' in lost.reason


@pytest.mark.parametrize('estimator', ['multiple_model', 'rls'])
def test_an_estimate_whose_band_a_change_of_parameters_has_taken_says_so(estimator: str) -> None:
    pipeline, samples = pipeline_with(estimator=estimator), contact_samples(0.6)
    known = [pipeline.take(one) for one in samples][-1]
    pipeline.configure(changed(pipeline.parameters, {'environment.location': 0.001}))
    after = pipeline.take(samples[0]._replace(stamp_ns=samples[-1].stamp_ns + 2_000_000))
    assert (after.status, after.stiffness) == (FREE, known.stiffness)
    assert after.stiffness_std != after.stiffness_std
    assert 'the stiffness has no band' in after.reason


def test_an_estimator_that_states_no_deviations_has_lost_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(RecursiveLeastSquares, 'current', lambda own: ParameterEstimate(
        own.stiffness, own.damping, nan, nan, 0.0, nan))
    pipeline = pipeline_with(estimator='rls')
    last = [pipeline.take(one) for one in contact_samples(0.6)][-1]
    assert last.stiffness == pytest.approx(4800.0, rel=0.02)
    assert last.stiffness_std != last.stiffness_std
    assert 'band' not in last.reason


@pytest.mark.parametrize('step, factor', [(3.0, 1.0), (5.0, 1.0), (3.0, 1.5)])
def test_a_force_that_only_a_release_contradicts_changes_no_stiffness(
    step: float, factor: float,
) -> None:
    samples = two_presses()
    zero = np.where(samples.t > 3.84, step, 0.0)  # while the tool withdraws
    wall = np.where(samples.t > 3.0, factor, 1.0)
    last = estimates_of(samples._replace(force=wall * samples.force + zero))[-1]
    assert last.status is FREE
    assert last.stiffness == pytest.approx(factor * K, rel=0.005)
    assert last.stiffness_std < 0.01 * K


def laws(**chosen: float) -> tuple[float, ...]:
    return tuple(chosen.get(name, 0.0) for name in LAWS)


def test_the_most_probable_law_comes_first_and_what_rounds_to_zero_is_left_out() -> None:
    assert laws_in_words(laws(kelvin_voigt=0.238, mass=0.004, friction=0.758)) == (
        'friction 0.76 kelvin_voigt 0.24')


@pytest.mark.parametrize('then, told', [
    (laws(kelvin_voigt=0.55, friction=0.45), False),
    (laws(kelvin_voigt=0.45, friction=0.55), True),  # another leads
    (laws(kelvin_voigt=0.71, friction=0.29), True),  # by more than 0.1
])
def test_laws_are_told_on_change(then: tuple[float, ...], told: bool) -> None:
    news = WallLawNews()
    assert news.take(laws(kelvin_voigt=0.6, friction=0.4)) == 'kelvin_voigt 0.60 friction 0.40'
    assert bool(news.take(then)) == told
    assert news.take(tuple(then)) == ''


SAMPLES = contact_samples(0.3)
EVENTS = [
    EstimationEvent(CHANGE, 12, {'estimator': 'rls', 'conditioning.cutoff_frequency': 20.0}),
    EstimationEvent(RESET, 34, {}),
    EstimationEvent(TARE, -(2**63), {'force_bias': 0.125}, 1),
]


def feed(session: ContactSession, begin: int, end: int) -> list[str]:
    """Pass samples and give the estimates as text."""
    estimates = []
    for stamp, position, velocity, force in SAMPLES[begin:end]:
        session.add_motion(stamp, position, velocity)
        estimates += [repr(r.estimate) for r in session.add_wrench(stamp, force)]
    return estimates


@pytest.mark.parametrize('event', EVENTS, ids=lambda e: e.kind)
def test_event_survives_its_text(event: EstimationEvent) -> None:
    assert EstimationEvent.from_text(event.to_text()) == event


def test_start_event_restores_all_parameters() -> None:
    parameters = build(EstimationParameters, {'estimator': 'kalman', 'sample_rate': 400.0})
    event = EstimationEvent.from_text(
        event_now(ContactSession(parameters), START, flatten(parameters)).to_text())
    assert repr(build(EstimationParameters, event.parameters)) == repr(parameters)


@pytest.mark.parametrize('text', ['', 'no json', '[]', '{}', '{"event": "reset"}', '3'])
def test_other_text_is_an_error(text: str) -> None:
    with pytest.raises(RecordingError, match='expected an estimation event as JSON'):
        EstimationEvent.from_text(text)


@pytest.mark.parametrize('event', EVENTS, ids=lambda e: e.kind)
def test_scheduled_event_acts_where_the_live_one_did(event: EstimationEvent) -> None:
    live, replay = (ContactSession(EstimationParameters()) for _ in range(2))
    expected = feed(live, 0, 300)
    apply_event(live, event)
    expected += feed(live, 300, len(SAMPLES))
    replay.schedule(Moment(0, SAMPLES[299].stamp_ns), lambda: apply_event(replay, event))
    assert feed(replay, 0, len(SAMPLES)) == expected


FAULT_S, CLEAN_S, FIRST_S = 2.0, 7.0, 2.5
PERIOD_S = 1.75  # of the presses
EPOCH_NS = 10**18
Stamps = NDArray[np.int64]

FAULTS = ('noise_burst', 'flipped_sign', 'frozen_force', 'frozen_position', 'wild_values',
          'silence', 'clock_back', 'zero_step')


def spoil(
    fault: str, stamps: Stamps, force: Array, x: Array, part: slice, draw: np.random.Generator
) -> None:
    """Let a fault happen to a part of a recording; silence is a stamp of -1."""
    if fault == 'noise_burst':
        force[part] += 5.0 * draw.standard_normal(len(force[part]))
    elif fault == 'flipped_sign':
        force[part] *= -1.0
    elif fault == 'frozen_force':
        force[part] = force[part.start]
    elif fault == 'frozen_position':
        x[part] = x[part.start]
    elif fault == 'wild_values':
        for values in (force, x):
            some = draw.uniform(size=len(force)) < 0.5
            some[:part.start] = some[part.stop:] = False
            values[some] = draw.choice([nan, inf, -inf, 1e300, 1e6, -500.0, 0.0], int(some.sum()))
    elif fault == 'silence':
        stamps[part] = -1
    elif fault == 'clock_back':
        stamps[part.start:] -= np.where(stamps[part.start:] < 0, 0, 20 * 10**9)
    else:
        force[part] -= 4.0


@lru_cache(maxsize=4)
def clean(seconds: float, seed: int) -> tuple[Stamps, Array, Array]:
    """Return stamps, F_e and x of one press after the other."""
    count = int(seconds / PERIOD_S) + 1
    presses = tuple((PERIOD_S * k + 0.3, PERIOD_S * k + 1.6) for k in range(count))
    t, force, x, _ = contact(spring_damper(K, B), seconds, presses=presses, seed=seed)
    return EPOCH_NS + np.round(1e9 * t).astype(np.int64), -force, x


def estimates_after(faults: list[str], seed: int) -> list[Estimate]:
    """Return the estimates of a session that has met faults, one after the other."""
    end_s = FIRST_S + FAULT_S * len(faults)
    stamps, force, x = clean(end_s + CLEAN_S, seed)
    stamps, force, x = stamps.copy(), force.copy(), x.copy()
    draw = np.random.default_rng(seed)
    for k, name in enumerate(faults):
        part = slice(*(round(500.0 * (FIRST_S + FAULT_S * j)) for j in (k, k + 1)))
        spoil(name, stamps, force, x, part, draw)
    session = ContactSession(EstimationParameters())
    estimates = []
    for stamp, f, position in zip(stamps.tolist(), force.tolist(), x.tolist()):
        if stamp >= 0:
            session.add_motion(stamp, position, nan)
            estimates += [one.estimate for one in session.add_wrench(stamp, f)]
    return estimates


def recovers(faults: list[str], seed: int = 0) -> None:
    """Require a right estimate and a contact at the end of the clean presses."""
    recent = estimates_after(faults, seed)[-round(500.0 * PERIOD_S):]
    last = recent[-1]
    assert any(one.status is EstimateStatus.ESTIMATING for one in recent), (faults, last)
    assert abs(last.stiffness - K) <= max(0.02 * K, 2.0 * last.stiffness_std), (faults, last)


@pytest.mark.slow
@pytest.mark.parametrize('fault', FAULTS)
def test_recovers_from_a_fault(fault: str) -> None:
    recovers([fault])


@pytest.mark.slow
@given(st.lists(st.sampled_from(FAULTS), min_size=2, max_size=3), st.integers(0, 3))
@settings(derandomize=True, deadline=None, max_examples=5, database=None,
          phases=(Phase.explicit, Phase.generate))
def test_recovers_from_faults_in_any_order(faults: list[str], seed: int) -> None:
    recovers(faults, seed)
