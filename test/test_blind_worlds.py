# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Randomised worlds of blind_trials: random draws, concealment, sensor model."""

from __future__ import annotations


from blind_worlds import synthetic_run, WORLD
from contact_estimation.blind_trials.concealment import residual
from contact_estimation.blind_trials.measurement import measure, TRUTH_HZ
from contact_estimation.blind_trials.simulation import Run
from contact_estimation.blind_trials.trial import EFFECTS_OF_A_WALL, plan_effects
from contact_estimation.blind_trials.worlds import RandomWorld, SensorModel
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.scales import Scales
import numpy as np
import pytest

SCALES = Scales(0.02, 0.1, 80.0, 150.0, 0.0, 15.0, 4000.0, 100.0, 20.0)


def rms_of(in_motion: bool, world: RandomWorld, run: Run) -> float:
    """Return the RMS residual of the contact, or that in the motion of the robot."""
    return float(np.sqrt(np.nanmean(residual(in_motion, world, run) ** 2)))


def slow_press(count: int = 20000) -> Run:
    """Return true signals with a linearly growing force."""
    t = np.arange(count) / TRUTH_HZ
    still = np.zeros(count)
    return Run(t, 0.001 * t, still + 0.001, -10.0 * t, -10.0 * t, still, still, still)


# -- random draws ---------------------------------------------------------------------------


def test_a_plan_has_every_effect_once_before_any_comes_twice() -> None:
    count = len(EFFECTS_OF_A_WALL)
    effects = plan_effects(2 * count, 5)
    assert sorted(effects[:count]) == sorted(effects[count:]) == sorted(EFFECTS_OF_A_WALL)
    assert plan_effects(7, 5) == effects[:7]


def test_parameters_move_away_from_neutral_as_the_strength_grows() -> None:
    for name in EFFECTS:
        strength = EFFECTS[name].draw(SCALES, np.random.default_rng(1))
        neutral = EFFECTS[name].neutral

        def distance(s: float) -> float:
            values = strength(s)
            if 'limit' in values:
                return max(SCALES.force, SCALES.control) - values['limit']
            return sum(abs(v - neutral.get(k, 0.0)) for k, v in values.items() if k != 'K_n')

        assert distance(0.2) < distance(0.4), name
        cls = EFFECTS[name]
        assert cls(cls.Parameters(**strength(0.3))).plausible(cls.Parameters(**strength(0.3)))


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


def test_stamps_jitter_but_increase_and_some_samples_are_dropped() -> None:
    sensors = SensorModel(jitter=4e-5, dropped=0.02)
    force, joint, _, _ = measure(slow_press(), sensors, np.random.default_rng(0))
    steps = np.diff(force.stamps) * 1e-9
    whole = steps[steps < 0.003]
    assert np.min(steps) > 0.0
    assert float(np.std(whole)) == pytest.approx(4e-5 * 2.0**0.5, rel=0.1)
    assert 0.005 < np.mean(steps > 0.003) < 0.04
    assert list(force.stamps) != list(joint.stamps)
