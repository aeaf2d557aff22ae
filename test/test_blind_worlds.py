# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Randomised worlds of blind_trials: random draws, concealment, sensor model."""

from __future__ import annotations

from blind_worlds import synthetic_run, WORLD
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.prior import Scales
from contact_estimation.studies.blind_trials.concealment import residual
from contact_estimation.studies.blind_trials.trial import EFFECTS_OF_A_WALL, plan_effects
from contact_estimation.studies.blind_trials.worlds import RandomWorld, Run
import numpy as np
import pytest

SCALES = Scales(0.02, 0.1, 80.0, 150.0, 0.0, 15.0, 4000.0, 100.0, 20.0)


def rms_of(in_motion: bool, world: RandomWorld, run: Run) -> float:
    """Return the RMS residual of the contact, or that in the motion of the robot."""
    return float(np.sqrt(np.nanmean(residual(in_motion, world, run) ** 2)))


# -- random draws ---------------------------------------------------------------------------


def test_a_plan_has_every_effect_once_before_any_comes_twice() -> None:
    count = len(EFFECTS_OF_A_WALL)
    effects = plan_effects(2 * count, 5)
    assert sorted(effects[:count]) == sorted(effects[count:]) == sorted(EFFECTS_OF_A_WALL)
    assert plan_effects(7, 5) == effects[:7]


def test_parameters_move_away_from_neutral_as_the_strength_grows() -> None:
    for name in EFFECTS:
        strength = EFFECTS[name].draw(SCALES, np.random.default_rng(1))
        neutral = EFFECTS[name].neutral()

        def distance(s: float) -> float:
            values = strength(s)
            if 'limit' in values:
                return max(SCALES.force, SCALES.control) - values['limit']
            return sum(abs(v - neutral.get(k, 0.0)) for k, v in values.items() if k != 'K_n')

        assert distance(0.2) < distance(0.4), name
        assert EFFECTS[name](**strength(0.3)).is_possible(SCALES.stiffness, SCALES.damping), name


# -- concealment ----------------------------------------------------------------------------


def test_contact_residual_matches_the_normal_equations() -> None:
    run = synthetic_run()
    extra = np.where(run.force < 0.0, -0.7 * np.tanh(run.v / 4e-4), 0.0)
    on = (run.force < 0.0) & (run.x > 0.0)
    touching = run.x > 0.0
    A = np.column_stack((run.x, run.v))[on]
    K, B = np.linalg.solve(A.T @ A, -A.T @ (run.force + extra)[on])
    predicted = np.minimum(0.0, -K * run.x - B * run.v)[touching]
    rms = float(np.sqrt(np.mean(((run.force + extra)[touching] - predicted) ** 2)))
    assert rms_of(False, WORLD, synthetic_run(run.force + extra)) == pytest.approx(rms)


# -- sensors --------------------------------------------------------------------------------
