# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The target of an arm keeps within its lead and its box."""

from __future__ import annotations

from math import nan

from contact_estimation.estimation.target_pose import step_along
from contact_estimation.exceptions import ParameterRangeError
from contact_estimation.reference.parameters import PoseLimits
import pytest

DOWN = (0.0, 0.0, -1.0)
BOX = PoseLimits(lead=0.05, lower=(-1.0, -1.0, 0.1), upper=(1.0, 1.0, 0.5))


@pytest.mark.parametrize('position, step, expected', [
    ((0.0, 0.0, 0.3), 0.02, 0.02),
    ((0.0, 0.0, 0.3), 0.20, 0.05),  # the lead
    ((0.0, 0.0, 0.3), -0.20, -0.05),
    ((0.0, 0.0, 0.12), 0.04, 0.02),  # the floor of the box
    ((0.0, 0.0, 0.08), 0.04, -0.02),  # back into it
    ((0.0, 0.0, 0.0), 0.04, None),  # further out than the lead
    ((0.0, 1.5, 0.3), 0.01, None),  # beside it
    ((0.0, 0.0, 0.3), nan, None),
])
def test_steps_stay_within_lead_and_box(
    position: tuple[float, ...], step: float, expected: float | None
) -> None:
    assert step_along(position, DOWN, step, BOX) == (
        None if expected is None else pytest.approx(expected))


def test_an_empty_box_is_refused() -> None:
    with pytest.raises(ParameterRangeError, match=r'lower must be <= .*got \[0.0, 0.0, 2.0'):
        PoseLimits(lower=(0.0, 0.0, 2.0), upper=(1.0, 1.0, 1.0))
