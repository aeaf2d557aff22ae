# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The margin that the node publishes: of its gains on the wall as estimated."""

from __future__ import annotations

from dataclasses import replace
from math import isnan, nan

import contact_estimation as ce
from contact_estimation.reference.stable_gains import StabilityParameters, StabilityWatch
import pytest

ROBOT = StabilityParameters('admittance', 5.0, 300.0, 0.0, 0.002, 0.01)
WALL = 20_000.0, 500.0, 50.0, 5.0


def test_margin_is_that_of_stable_gains_within_the_band() -> None:
    watch = StabilityWatch()
    expected = ce.stable_gains(20_000.0, 50.0, M_t=5.0, B_t=300.0, K_t=0.0, sample_time=0.002,
                               delay=0.01, K_e_std=500.0, B_e_std=5.0)
    assert watch.take(ROBOT, *WALL) == expected.least_phase_margin < expected.phase_margin
    assert watch.values['least_damping'] == expected.least_damping
    assert f'raise stability.damping (B_t) to {expected.least_damping:.3g}' in watch.text(ROBOT)


def test_wall_is_judged_again_only_where_it_has_changed() -> None:
    watch = StabilityWatch()
    watch.take(ROBOT, *WALL)
    before = watch.gains
    watch.take(ROBOT, 20_100.0, *WALL[1:])
    assert watch.gains is before
    assert watch.take(ROBOT, 40_000.0, *WALL[1:]) < 0.0
    assert 'may be unstable' in watch.text(ROBOT)
    assert watch.take(replace(ROBOT, damping=2000.0), 40_000.0, *WALL[1:]) > 0.0


@pytest.mark.parametrize('robot, K_e', [(replace(ROBOT, kind='off'), 5e3), (ROBOT, nan)])
def test_nothing_is_judged_without_gains_or_wall(robot: StabilityParameters, K_e: float) -> None:
    watch = StabilityWatch()
    assert isnan(watch.take(robot, K_e, *WALL[1:]))
    assert watch.values == {} and watch.text(robot) == ''
