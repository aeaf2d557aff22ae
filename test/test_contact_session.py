# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The session: samples paired by stamp, and what becomes of them."""

from math import inf, isfinite, nan
from typing import Any, Iterable

from contact_estimation.estimators import ESTIMATORS
from contact_estimation.exceptions import ContactEstimationError
from contact_estimation.parameters import build, ParameterSpecification, specifications
from contact_estimation.pipeline.axes import Result
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.reference.setpoints import Desired, Reference
from contact_estimation.signals.contact_sample import ContactSample
from contact_estimation.signals.synchronisation import SynchronisationParameters, Synchroniser
from core_runs import closed_loop, contact_samples, PAPER_SENSORS, PERIOD_NS
from effect_examples import switched_on
import numpy as np
import pytest

MS = 1_000_000
Message = tuple[str, int]  # kind, stamp_ns


def synchroniser() -> Synchroniser:
    """Make a synchroniser: time-out 100 ms, gap 50 ms, jump 500 ms."""
    return Synchroniser(SynchronisationParameters())


def send(of: Synchroniser, messages: list[Message]) -> list[ContactSample]:
    """Send messages whose content follows from their stamps."""
    samples: list[ContactSample] = []
    for kind, stamp in messages:
        if kind == 'wrench':
            samples.extend(one for (one,) in of.add_wrench(stamp, (-1e-6 * stamp,)))
        else:
            motion = 1e-9 * stamp, 1.0 + 1e-12 * stamp
            samples.extend(one for (one,) in of.add_motion(stamp, motion))
    return samples


def streams(milliseconds: range, shift_ns: int = 0) -> list[Message]:
    """Wrench and joint at the same times, the joint later by a shift."""
    return [m for t in milliseconds for m in (('wrench', t * MS), ('joint', t * MS + shift_ns))]


def stamps_ms(samples: list[ContactSample]) -> list[float]:
    """Stamps in milliseconds."""
    return [sample.stamp_ns / MS for sample in samples]


def test_motion_is_interpolated_to_the_wrench() -> None:
    of = synchroniser()
    of.add_motion(0, (1.0, 10.0))
    of.add_wrench(3 * MS, (-5.0,))
    ((sample,),) = of.add_motion(4 * MS, (2.0, 20.0))
    assert sample == ContactSample(3 * MS, 1.75, 17.5, -5.0)


def test_wrench_waits_for_a_joint_sample_at_or_after_it() -> None:
    of = synchroniser()
    of.add_motion(0, (1.0, 0.0))
    assert not list(of.add_wrench(MS, (0.0,)))
    ((sample,),) = of.add_motion(2 * MS, (1.0, 0.0))
    assert sample.stamp_ns == MS


@pytest.mark.parametrize('kind', ['wrench', 'joint'])
def test_duplicate_is_counted_and_the_rest_unharmed(kind: str) -> None:
    of, messages = synchroniser(), streams(range(0, 20, 2))
    doubled = [m for m in messages for _ in range(2 if m == (kind, 10 * MS) else 1)]
    assert send(of, doubled) == send(synchroniser(), messages)
    assert of.rejected == {f'{kind}_duplicate': 1}


@pytest.mark.parametrize('kind', ['wrench', 'joint'])
def test_late_sample_is_counted_and_the_rest_unharmed(kind: str) -> None:
    of, messages = synchroniser(), streams(range(0, 20, 2))
    at = messages.index((kind, 10 * MS)) + 1
    late = [*messages[:at], (kind, 7 * MS), *messages[at:]]
    assert send(of, late) == send(synchroniser(), messages)
    assert of.rejected == {f'{kind}_out_of_order': 1}


@pytest.mark.parametrize('force', [nan, inf, -inf])
def test_wrench_that_is_not_finite_is_counted_and_the_rest_unharmed(force: float) -> None:
    of = synchroniser()
    samples = send(of, streams(range(0, 10, 2)))
    of.add_wrench(10 * MS, (force,))
    samples += send(of, [('joint', 10 * MS), *streams(range(12, 20, 2))])
    assert stamps_ms(samples) == [0, 2, 4, 6, 8, 12, 14, 16, 18]
    assert of.rejected == {'wrench_not_finite': 1}


@pytest.mark.parametrize('position', [nan, inf, -inf])
def test_joint_that_is_not_finite_is_counted_and_bridged(position: float) -> None:
    of = synchroniser()
    samples = send(of, streams(range(0, 10, 2)))
    of.add_motion(10 * MS, (position, 0.0))
    samples += send(of, [('wrench', 10 * MS), *streams(range(12, 20, 2))])
    assert stamps_ms(samples) == list(range(0, 20, 2))
    assert samples[5].position == pytest.approx(1e-9 * 10 * MS)
    assert of.rejected == {'joint_not_finite': 1}


def test_wrench_is_given_up_after_the_time_out_in_stamps() -> None:
    of = synchroniser()
    send(of, [('joint', 0), ('wrench', 2 * MS), ('wrench', 102 * MS)])
    assert not of.rejected
    send(of, [('wrench', 103 * MS)])
    assert of.rejected == {'joint_missing': 1}


@pytest.mark.parametrize('first', ['wrench', 'joint'])
def test_time_that_jumps_back_starts_anew(first: str) -> None:
    of, again = synchroniser(), streams(range(2, 22, 2))
    again.sort(key=lambda m: (m[1], m[0] != first))
    send(of, streams(range(5000, 5020, 2)))
    assert send(of, again) == send(synchroniser(), again)
    assert of.time_jumps == 1 and of.jumped


def test_any_arrival_within_the_time_out_gives_bit_identical_samples() -> None:
    for seed in range(5):
        for shift_ns in [0, 700_000]:
            random = np.random.default_rng(seed)
            messages = streams(range(0, 1000, 2), shift_ns)
            delay = {'wrench': 0.0, 'joint': 0.0}
            arrivals: list[tuple[float, int, Message]] = []
            for kind, stamp in messages:  # each topic keeps its order
                delay[kind] = max(delay[kind], stamp + float(random.uniform(0.0, 45.0)) * MS)
                arrivals.append((delay[kind], len(arrivals), (kind, stamp)))
            shuffled = [message for _, _, message in sorted(arrivals)]
            of, expected = synchroniser(), synchroniser()
            assert send(of, shuffled) == send(expected, messages), (seed, shift_ns)
            assert of.rejected == expected.rejected, (seed, shift_ns)


SPECIFICATIONS = list(specifications(EstimationParameters))
# The tool needs an arm: see test_arm.py.
CHANGEABLE = [spec for spec in SPECIFICATIONS
              if not spec.read_only and not spec.name.startswith('tool.')]
NUMBERS = [spec for spec in CHANGEABLE if type(spec.default) in (int, float)]
LOWER = [spec for spec in NUMBERS if spec.minimum is not None]
# At their least, the ranges of the sensors reject every sample: see test_synchronisation.py.
RANGES = [f'synchronisation.maximum_{name}' for name in ('force', 'position', 'velocity')]
# Ten seconds apart, no joint state is left for the last wrenches.
OFFSET = 'synchronisation.offset'
SAMPLES = contact_samples(0.2, force_noise=0.3)[60:]
IN_CONTACT = 190  # of SAMPLES: at full depth, where the sine begins


def session_for(name: str = '', **estimation: Any) -> ContactSession:
    """Make a session that runs the estimator to which a parameter belongs."""
    tuned = name.split('.')[1] if name.startswith('tuning.') else 'indirect_adaptive'
    return ContactSession(build(EstimationParameters, {'estimator': tuned, **estimation}))


def feed(session: ContactSession, samples: list[ContactSample]) -> list[Result]:
    """Pass samples to a session as the two topics would."""
    results = []
    for stamp, position, velocity, force in samples:
        results += session.add_motion(stamp, position, velocity)
        results += session.add_wrench(stamp, force)
    return results


def _like(spec: ParameterSpecification, number: float) -> int | float:
    """Return a number of the type of a parameter."""
    return int(number) if isinstance(spec.default, int) else float(number)


def finite(results: list[Result]) -> bool:
    """Tell whether all estimates and references are finite."""
    return all(
        isfinite(value)
        for r in results
        for value in (r.estimate.stiffness, r.estimate.damping, r.estimate.location,
                      *(r.reference or ())))


def problem_after(name: str, value: Any) -> str:
    """Change a parameter in contact; return what is wrong with the results, '' if nothing."""
    session = session_for(name)
    feed(session, SAMPLES[:IN_CONTACT])
    together = {'conditioning.cutoff_frequency': 0.0} if name == 'sample_rate' else {}
    if name.startswith('physics.'):  # an effect needs all of its parameters
        together = switched_on(name.split('.')[1])
    try:
        session.change_parameters({**together, name: value})
        results = feed(session, SAMPLES[IN_CONTACT:])
    except Exception as error:  # noqa: B902 - every parameter shall be tried
        return f'{name} = {value!r}: {error!r}'
    missing = len(SAMPLES) - IN_CONTACT - len(results)
    if missing or not finite(results):
        return f'{name} = {value!r}: {missing} results missing, finite: {finite(results)}'
    return ''


def problems(changes: Iterable[tuple[str, Any]]) -> list[str]:
    """Change each parameter in contact, each in a session of its own."""
    found = [problem_after(name, value) for name, value in changes]
    assert found  # at least one parameter was tried
    return [text for text in found if text]


@pytest.mark.slow
def test_every_parameter_can_be_set_to_its_minimum_in_contact() -> None:
    assert not problems((spec.name, _like(spec, spec.minimum or 0))
                        for spec in LOWER if spec.name not in (*RANGES, OFFSET))


def test_refused_change_leaves_the_estimates_as_they_would_have_been() -> None:
    asked, undisturbed = session_for(), session_for()
    for session in (asked, undisturbed):
        feed(session, SAMPLES[:IN_CONTACT])
    with pytest.raises(ContactEstimationError, match='reference_law'):
        asked.change_parameters({
            'reference_law': 'series', 'reference.robot_force_tracking': True,
            'estimator': 'rls', 'conditioning.cutoff_frequency': 20.0,
        })
    rest = SAMPLES[IN_CONTACT:]
    assert repr(feed(asked, rest)) == repr(feed(undisturbed, rest))


@pytest.mark.slow
@pytest.mark.parametrize('estimator', ESTIMATORS)
def test_replay_of_the_samples_gives_the_live_estimates(estimator: str) -> None:
    live = closed_loop({'estimator': estimator}, PAPER_SENSORS).results[:3500]
    replay = ContactSession(build(EstimationParameters, {'estimator': estimator}), False)
    replayed = []
    for result in live:
        replayed += feed(replay, [result.sample])
        assert result.reference is not None
        replay.add_reference(result.reference_stamp_ns, Reference(*result.reference[:3]))
    assert [repr(r.estimate) for r in replayed] == [repr(r.estimate) for r in live]


def test_desired_of_the_future_waits_for_its_stamp() -> None:
    session = session_for()
    first = SAMPLES[0].stamp_ns
    session.add_desired(first + PERIOD_NS, Desired(-0.0102, 0.0, 0.0, nan))
    session.add_desired(first + 2 * PERIOD_NS, Desired(-0.0104, 0.0, 0.0, nan))
    references = [r.reference for r in feed(session, SAMPLES[:2])]
    assert [r.position for r in references if r] == [-0.0102, -0.0104]


def test_backward_clock_jump_keeps_the_estimate() -> None:
    session = session_for()
    learned = feed(session, SAMPLES)[-1].estimate
    (first, *_) = feed(session, SAMPLES[:10])
    assert (first.estimate.stiffness, session.time_jumps) == (learned.stiffness, 1)


@pytest.mark.parametrize('force', [-30.0, 0.0, inf])
def test_desired_force_that_is_not_positive_counts_as_none(force: float) -> None:
    session = session_for()
    session.add_desired(SAMPLES[0].stamp_ns, Desired(-0.0102, 0.0, 0.0, force))
    (result,) = feed(session, SAMPLES[:1])
    assert result.reference == (-0.0102, 0.0, 0.0, 0.0)
