# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Stamps that are those of no measurement are rejected; a clock that was set is followed."""

from __future__ import annotations

from collections import Counter
from math import inf, nan
from typing import Any

from contact_estimation.signals.stamp_screen import BEFORE_ANY, CONFIRMING, StampScreen
import pytest

GAP_NS, JUMP_NS, LAST_NS = 50, 500, 10_000


def admitted(
    stamps: list[Any], last_ns: int = LAST_NS, other_ns: int = LAST_NS
) -> tuple[list[int], dict[str, int]]:
    """Screen stamps after others; return those that are used, and the rejections."""
    rejected: Counter[str] = Counter()
    screen, used = StampScreen('wrench', rejected), list[int]()
    screen.before_ns = last_ns - 2 if last_ns != BEFORE_ANY else last_ns
    for stamp in stamps:
        for stamp_ns, _ in screen.admit((stamp, None), last_ns, other_ns, GAP_NS, JUMP_NS):
            used.append(stamp_ns)
            screen.before_ns, last_ns = last_ns, stamp_ns
    return used, dict(rejected)


def test_a_stamp_of_no_measurement_is_rejected_at_once() -> None:
    for stamp, reason in [
        (0, 'zero_stamp'), (-1, 'invalid_stamp'), (-2**63, 'invalid_stamp'),
        (2**63, 'invalid_stamp'),
        (nan, 'invalid_stamp'), (inf, 'invalid_stamp'), (-inf, 'invalid_stamp'),
        (LAST_NS, 'duplicate'), (LAST_NS - 1, 'out_of_order'),
    ]:
        assert admitted([stamp]) == ([], {f'wrench_{reason}': 1}), (stamp, reason)
        later = [LAST_NS + k for k in range(1, 9)]
        assert admitted([stamp, *later])[0] == later, (stamp, reason)


@pytest.mark.parametrize('stamp, reason', [
    (LAST_NS + GAP_NS + 1, 'future_stamp'), (LAST_NS - JUMP_NS - 1, 'past_stamp')])
def test_a_stamp_far_off_is_refuted_by_the_next(stamp: int, reason: str) -> None:
    assert admitted([stamp]) == ([], {})  # nothing is known yet
    assert admitted([stamp, LAST_NS + 2]) == ([LAST_NS + 2], {f'wrench_{reason}': 1})


@pytest.mark.parametrize('begin', [LAST_NS + GAP_NS + 1, 10**9, 1])
def test_messages_that_increase_prove_a_new_clock_and_none_is_lost(begin: int) -> None:
    clock = [begin + 2 * k for k in range(CONFIRMING + 3)]
    assert admitted(clock[:CONFIRMING - 1]) == ([], {})
    assert admitted(clock) == (clock, {})


def test_messages_on_either_side_prove_no_clock() -> None:
    stamps = [LAST_NS + 900, LAST_NS - 900] * CONFIRMING
    used, rejected = admitted([*stamps, LAST_NS + 1])
    assert used == [LAST_NS + 1] and sum(rejected.values()) == len(stamps)


def test_a_clock_that_the_other_topic_has_is_followed_at_once() -> None:
    assert admitted([20_000, 20_002], other_ns=20_001) == ([20_000, 20_002], {})
