# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""x_r keeps its limits of rate and reach over the true time of the robot, whatever stamps say."""

from __future__ import annotations

from math import nan
from typing import Any

from contact_estimation.parameters import build
from contact_estimation.pipeline.axes import Result
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
from contact_estimation.reference.setpoints import Desired
from contact_estimation.signals.contact_sample import ContactSample
from contact_estimation.signals.stamp_screen import CONFIRMING
from core_runs import contact_samples, PERIOD_NS
from hostile_loop import CHANGES, drawn, Event, HostileLoop, T, TOPICS
from hypothesis import given, Phase, settings, strategies as st
import numpy as np
import pytest

SPEED = 0.25  # reference.maximum_velocity
FAR = st.floats(1e-3, 1e4).flatmap(lambda s: st.sampled_from([s, -s]))
DESIRED = st.builds(
    Desired, st.floats(-0.1, 0.1), st.floats(-1.0, 1.0), st.just(0.0), st.floats(0.0, 100.0))


def event(kinds: str, values: st.SearchStrategy[Any] = st.none()) -> st.SearchStrategy[Event]:
    """Draw one of some kinds of events, its value and its topics."""
    kind, topics = st.sampled_from(kinds.split()), st.sampled_from(TOPICS)
    return st.tuples(kind, values, topics).map(lambda drawn: Event(*drawn))


EVENT = st.one_of(
    event('shift clock', FAR), event('stamp', st.sampled_from([0, -1, 2**63, nan])),
    event('drop twice reset tare set_location'), event('withhold', st.integers(1, 20)),
    event('desired', DESIRED), event('change', st.sampled_from(
        [(name, value) for name, values in CHANGES.items() for value in values])))


@pytest.mark.slow
def test_no_storm_of_stamps_services_and_parameters_breaks_a_limit() -> None:
    for seed in range(100):
        events = drawn(np.random.default_rng(seed), 150)
        assert (seed, HostileLoop(seed).run(events)) == (seed, [])


@settings(derandomize=True, database=None, deadline=None, max_examples=60,
          phases=(Phase.explicit, Phase.generate))
@given(st.lists(st.tuples(EVENT, st.integers(0, 12)), min_size=3, max_size=20))
def test_no_sequence_of_events_breaks_a_limit(pauses: list[tuple[Event, int]]) -> None:
    events = [one for event, pause in pauses for one in [event, *[Event('plain')] * pause]]
    assert HostileLoop().run(events) == []


@pytest.mark.parametrize('events, reasons, jumps', [
    ([Event('stamp', 0)], {'joint_zero_stamp': 1, 'wrench_zero_stamp': 1}, 0),
    ([Event('stamp', -5)], {'joint_invalid_stamp': 1, 'wrench_invalid_stamp': 1}, 0),
    ([Event('stamp', nan)], {'joint_invalid_stamp': 1, 'wrench_invalid_stamp': 1}, 0),
    ([Event('shift', 0.6)], {'joint_future_stamp': 1, 'wrench_future_stamp': 1}, 0),
    ([Event('shift', -3.0, 'wrench')], {'wrench_past_stamp': 1}, 0),
    ([Event('shift', 1e4)] * (CONFIRMING - 1),
     {'joint_future_stamp': CONFIRMING - 1, 'wrench_future_stamp': CONFIRMING - 1}, 0),
    ([Event('clock', -3600.0)], {}, 1), ([Event('clock', 3600.0)], {}, 0),
])
def test_false_stamps_are_counted_and_only_a_clock_that_stays_is_followed(
    events: list[Event], reasons: dict[str, int], jumps: int
) -> None:
    loop = HostileLoop()
    loop.run([*events, *[Event('plain')] * 20])
    session = loop.session
    assert (+session.rejected, session.time_jumps, loop.violations) == (reasons, jumps, [])
    assert session.last_stamp_ns == loop.now_ns


def pressed(force: float = 30.0) -> tuple[ContactSession, list[Result], int]:
    """Press the wall; return the session, its results, and the stamp after them."""
    session = ContactSession(build(EstimationParameters, {'force_reference': force}))
    samples = [s._replace(stamp_ns=s.stamp_ns + 10**9) for s in contact_samples(0.5)]
    return session, fed(session, samples), samples[-1].stamp_ns + PERIOD_NS


def fed(session: ContactSession, samples: list[ContactSample]) -> list[Result]:
    """Pass samples to a session."""
    results = []
    for stamp_ns, position, velocity, force in samples:
        session.add_motion(stamp_ns, position, velocity)
        results += session.add_wrench(stamp_ns, force)
    return results


def positions(results: list[Result]) -> list[float]:
    """Positions of the references."""
    return [result.reference.position for result in results if result.reference]


def test_after_a_clock_jump_the_reference_goes_on_from_the_last() -> None:
    session, before, _ = pressed()
    x = before[-1].sample.position
    after = fed(session, [ContactSample(10**6 + k * PERIOD_NS, x, 0.0, -20.0) for k in range(9)])
    x_r = positions([before[-1], *after])
    assert session.time_jumps == 1 and len(after) == 9
    assert max(np.abs(np.diff(x_r))) <= SPEED * T * (1.0 + 1e-9)
