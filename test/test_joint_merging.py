# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Joint states in several messages become motions of all joints."""

from __future__ import annotations

from math import nan, pi

from contact_estimation.signals.joint_merging import JointMerger
import pytest


def test_parts_with_one_stamp_are_put_together() -> None:
    merger = JointMerger([False, False])
    assert merger.add(5, (1.0, nan), (3.0, nan)) is None
    assert merger.missing == [1]
    assert merger.add(5, (nan, 2.0), (nan, 4.0)) == (5, [1.0, 2.0, 3.0, 4.0])
    assert merger.missing == []


def test_parts_with_other_stamps_are_interpolated_to_the_one_behind() -> None:
    merger = JointMerger([False, False])
    merger.add(10, (1.0, nan), (0.0, nan))
    merger.add(11, (nan, 2.0), (nan, 0.0))  # the first source has no value at 11 yet
    first = merger.add(14, (3.0, nan), (4.0, nan))
    second = merger.add(12, (nan, 2.5), (nan, 0.0))
    assert first is not None and second is not None
    assert (first[0], second[0]) == (11, 12)
    assert first[1] == pytest.approx([1.5, 2.0, 1.0, 0.0])
    assert second[1] == pytest.approx([2.0, 2.5, 2.0, 0.0])


def test_an_unlimited_joint_turns_on_where_its_angle_wraps() -> None:
    merger = JointMerger([True])
    rows = [merger.add(k, (angle,), (1.0,)) for k, angle in enumerate([3.0, -3.1, 3.1, 0.0])]
    assert [row[1][0] for row in rows if row] == pytest.approx([3.0, 2 * pi - 3.1, 3.1, 0.0])
