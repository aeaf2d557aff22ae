# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The session: results, live parameter changes, replay equal to live."""

from __future__ import annotations

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
from core_runs import closed_loop, contact_samples, PAPER_SENSORS, PERIOD_NS
from effect_examples import switched_on
import pytest

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
                      *(r.reference or ()))
    )


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
