# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Several axes at once: each is estimated as if it were alone, from the same messages."""

from __future__ import annotations

from typing import Any

from axes_runs import (
    AXES, feed_axes, feed_axis, Instant, instants, PARAMETERS, session_of_axes, session_of_axis)
from contact_estimation.estimators import ESTIMATORS
from contact_estimation.exceptions import ContactEstimationError
from contact_estimation.parameters import build
from contact_estimation.pipeline.axes import Result
from contact_estimation.pipeline.events import (
    apply_event, biases, EstimationEvent, event_now, TARE)
from contact_estimation.pipeline.parameters import EstimationParameters
import pytest

SAMPLES = instants()


def estimates_by_axis(results: list[Result]) -> dict[str, list[Any]]:
    """Sort estimates by axis."""
    columns = zip(*(r.estimates for r in results))
    return dict(zip(AXES, map(list, columns)))


@pytest.mark.slow
@pytest.mark.parametrize('estimator', ESTIMATORS)
def test_every_axis_is_estimated_as_if_it_were_alone(estimator: str) -> None:
    together = estimates_by_axis(feed_axes(session_of_axes(False, estimator=estimator), SAMPLES))
    for axis in AXES:
        session = session_of_axis(axis, False, estimator=estimator)
        single = feed_axis(session, [s.of_axis(axis) for s in SAMPLES])
        assert repr(together[axis]) == repr([r.estimate for r in single])


def test_reference_is_that_of_the_contact_axis_alone() -> None:
    together = feed_axes(session_of_axes(force_reference=20.0), SAMPLES)
    session = session_of_axis('x', force_reference=20.0)
    single = feed_axis(session, [s.of_axis('x') for s in SAMPLES])
    assert repr([r.reference for r in together]) == repr([r.reference for r in single])


def biased(samples: list[Instant], count: int) -> list[Instant]:
    """Rest in free flight under a bias."""
    first = samples[0]
    return [
        first._replace(stamp_ns=k * 2_000_000, forces=(1.0, -2.0, 3.0)) for k in range(count)
    ]


def test_tare_acts_on_every_axis_and_is_repeated_by_its_event() -> None:
    session, other = session_of_axes(), session_of_axes()
    feed_axes(session, biased(SAMPLES, 300))
    done, message = session.tare()
    assert done and message.startswith('x: force bias is now')
    event = event_now(session, TARE, biases(session))
    apply_event(other, EstimationEvent.from_text(event.to_text()))
    assert [p.bias for p in other.pipelines.values()] == pytest.approx([1.0, -2.0, 3.0])
    assert biases(other) == biases(session)


def test_tare_is_refused_for_all_while_one_axis_is_in_contact() -> None:
    session = session_of_axes()
    feed_axes(session, biased(SAMPLES, 300))
    touching = SAMPLES[0]._replace(forces=(0.0, -50.0, 0.0))
    y = touching.positions[1] + 0.02
    touching = touching._replace(positions=(touching.positions[0], y, touching.positions[2]))
    feed_axes(session, [touching._replace(stamp_ns=(300 + k) * 2_000_000) for k in range(3)])
    assert session.tare() == (False, 'y: in contact; move away from the wall and try again')
    assert set(biases(session).values()) == {0.0}


@pytest.mark.parametrize('wrong, text', [
    ({'further_axes.x.joint': 'a'}, 'further_axes.x.joint must be empty, since x is the contact'),
    ({'joint': ''}, 'joint must name the joint of axis x .* got an empty text'),
    ({'further_axes.y.joint': 'contact_z'}, 'must name different joints'),
])
def test_axes_that_do_not_fit_together_are_refused(wrong: dict[str, str], text: str) -> None:
    with pytest.raises(ContactEstimationError, match=text):
        build(EstimationParameters, {**PARAMETERS, **wrong})
