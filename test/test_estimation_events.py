# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Events as text, and their repetition at the same sample."""

from __future__ import annotations

from contact_estimation.estimation.events import (
    apply_event,
    CHANGE,
    EstimationEvent,
    event_now,
    RESET,
    START,
    TARE,
)
from contact_estimation.estimation.parameters import EstimationParameters
from contact_estimation.estimation.result import Moment
from contact_estimation.estimation.session import ContactSession
from contact_estimation.exceptions import RecordingError
from contact_estimation.parameters.values import build, flatten
from core_runs import contact_samples
import pytest

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
        event_now(ContactSession(parameters), START, flatten(parameters)).to_text()
    )
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
