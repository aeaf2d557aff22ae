# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""x_r keeps its limits of rate and reach over the true time of the robot, whatever stamps say."""

from __future__ import annotations

from math import nan
from typing import Any

from contact_estimation.reference.setpoints import Desired
from contact_estimation.signals.stream_faults import CONFIRMING
from hostile_loop import CHANGES, Event, HostileLoop, TOPICS
from hypothesis import given, Phase, settings, strategies as st
import pytest

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
