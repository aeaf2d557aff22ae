# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rejected messages are counted by reason, and the main reason is reported once."""

from __future__ import annotations

from contact_estimation.pipeline.checks import Rejections
from contact_estimation.pipeline.parameters import EstimationParameters
from contact_estimation.pipeline.session import ContactSession
import pytest


@pytest.mark.parametrize('counts, name, part', [
    ({'wrench_zero_stamp': 5}, 'zero_stamps', 'header.stamp'),
    ({'joint_invalid_stamp': 5}, 'invalid_stamps', 'of joint_states: their stamps are negative'),
    ({'wrench_future_stamp': 2, 'wrench_past_stamp': 2}, 'stamps_of_another_clock',
     '4 messages of wrench: their stamps are further ahead of those before and'),
    ({'wrench_frame_id': 3, 'joint_missing': 3}, 'frame', 'set frame_id'),
    ({'joint_states_joint_unknown': 4, 'joint_missing': 9}, 'joint', 'choose one of these'),
    ({'joint_gap': 4}, 'joint_gap', 'maximum_gap_s'),
    ({'joint_missing': 4}, 'joint_missing', '3 s behind'),
    ({'joint_duplicate': 4}, 'rejected', 'joint_duplicate'),
])
def test_rejections_say_the_main_reason(counts: dict[str, int], name: str, part: str) -> None:
    texts = {'wrench_frame_id': 'set frame_id',
             'joint_states_joint_unknown': 'choose one of these'}
    rejections = Rejections(lambda reason: texts.get(reason, ''), lambda: '3 s behind')
    found, text = rejections.new_warnings(counts, 0)
    assert found == name and part in text
    assert rejections.new_warnings(counts, 0) == ('', '')


def test_zero_stamps_are_counted_as_such() -> None:
    session = ContactSession(EstimationParameters())
    for _ in range(3):
        session.add_wrench(0, 1.0)
        session.add_motion(0, 1.0, 0.0)
    assert session.rejected == {'wrench_zero_stamp': 2, 'joint_zero_stamp': 2}
