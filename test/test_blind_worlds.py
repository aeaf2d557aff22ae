# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Randomised worlds of blind_trials: random draws, concealment, sensor model."""

from __future__ import annotations

from dataclasses import replace

from blind_worlds import ROBOT, short_trial, synthetic_run, WALL, WORLD
from contact_estimation.physics import EFFECTS
from contact_estimation.physics.contact_effect import ContactEffect
from contact_estimation.physics.drawn_effect import Scales
from contact_estimation.reference.experiment import Sine
from contact_estimation.studies.blind_trials.concealment import (
    active_intervals, conceal, degree, residual)
from contact_estimation.studies.blind_trials.experiments import draw_experiment, Faded, Stage
from contact_estimation.studies.blind_trials.trial import (
    draw_trial, EFFECTS_OF_A_WALL, equivalent_wall, MAX_DEGREE, MIN_DEGREE, plan_effects)
from contact_estimation.studies.blind_trials.worlds import (
    draw_nominal_wall, draw_world, measure, RandomWorld, Run, SensorModel, simulate, TRUTH_HZ)
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


@pytest.mark.parametrize('name', EFFECTS)
def test_parameters_move_away_from_neutral_as_the_strength_grows(name: str) -> None:
    strength = EFFECTS[name].draw(SCALES, np.random.default_rng(1))
    neutral = EFFECTS[name].neutral

    def distance(s: float) -> float:
        values = strength(s)
        if 'limit' in values:
            return max(SCALES.force, SCALES.control) - values['limit']
        return sum(abs(v - neutral.get(k, 0.0)) for k, v in values.items() if k != 'K_n')

    assert distance(0.2) < distance(0.4)
    cls = EFFECTS[name]
    assert cls(cls.Parameters(**strength(0.3))).plausible(cls.Parameters(**strength(0.3)))


def test_a_drawn_damping_drives_in_no_direction() -> None:
    lightly = SCALES._replace(damping=0.01 * SCALES.damper)
    cls = EFFECTS['asymmetric_damping']
    values = cls.Parameters(**cls.draw(lightly, np.random.default_rng(2))(0.99))
    assert not cls.drives(values, lightly.stiffness, lightly.damping)


class Plain(ContactEffect):
    """An effect that does not say how it is drawn."""

    Parameters = EFFECTS['viscoelastic_relaxation'].Parameters

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Two starts."""
        return [(40.0, 0.01), (40.0, 0.03)]


def test_an_effect_without_its_own_draw_grows_from_its_first_start() -> None:
    values = Plain.draw(SCALES, np.random.default_rng(0))(0.5)
    assert values == {'K_1': 0.5 * 30.0 * 40.0, 'tau': 0.01}


def test_nominal_stiffness_is_off_by_at_most_25_and_damping_by_60_percent() -> None:
    rng = np.random.default_rng(0)
    nominal = [draw_nominal_wall(WALL, rng, exact=0.0) for _ in range(300)]
    K = np.array([w.stiffness for w in nominal]) / WALL.stiffness - 1.0
    B = np.array([w.damping for w in nominal]) / WALL.damping - 1.0
    assert 0.2 < np.max(np.abs(K)) <= 0.25
    assert 0.5 < np.max(np.abs(B)) <= 0.6
    assert draw_nominal_wall(WALL, rng, exact=1.0) == WALL


@pytest.mark.slow
def test_a_quarter_of_worlds_lacks_velocity_and_a_fifth_drops_samples() -> None:
    rng = np.random.default_rng(0)
    drawn = [draw_world(rng).sensors for _ in range(800)]
    assert 0.2 < np.mean([s.velocity_noise is None for s in drawn]) < 0.3
    assert 0.16 < np.mean([s.dropped > 0.0 for s in drawn]) < 0.24


def test_hunt_crossley_wall_is_modelled_with_its_damping_at_half_depth() -> None:
    assert equivalent_wall('hunt_crossley_damping', {'chi': 2000.0}, WORLD).damping == 15.0
    assert equivalent_wall('coulomb_friction', {'F_c': 3.0}, WORLD) == WALL


@pytest.mark.slow
def test_experiments_have_consistent_derivatives_and_end_at_rest() -> None:
    for seed in range(6):
        experiment = draw_experiment(Stage(0.0, -0.02, 0.05), np.random.default_rng(seed))
        t = np.arange(0.0, experiment.duration, 1e-3)
        x, v, _, _ = np.array([experiment.desired(s) for s in t.tolist()]).T
        jumps = np.abs(np.diff(x)) > 0.002  # of a binary sequence
        rate = np.diff(x) / 1e-3
        assert np.max(np.abs(rate - 0.5 * (v[1:] + v[:-1]))[~jumps]) < 2e-3
        assert experiment.desired(experiment.duration).position == pytest.approx(-0.02)


def test_rates_of_a_faded_sine_match_finite_differences() -> None:
    faded, h = Faded(Sine(2.0, 9.0), 1.0, 3.0), 1e-5
    for t in (1.1, 1.25, 2.0, 2.85):
        first, second = faded.rates(t)
        before, now, after = (faded.value(t + k * h) for k in (-1, 0, 1))
        assert first == pytest.approx((after - before) / (2.0 * h), rel=1e-5)
        assert second == pytest.approx((after - 2.0 * now + before) / h**2, rel=1e-3, abs=1e-3)
    assert faded.value(0.9) == faded.value(3.1) == 0.0


# -- concealment ----------------------------------------------------------------------------


def test_contact_residual_of_a_spring_damper_is_zero() -> None:
    assert rms_of(False, WORLD, synthetic_run()) < 1e-9


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


def test_degree_is_residual_relative_to_the_force_noise() -> None:
    run = synthetic_run()
    biased = synthetic_run(run.force + 0.5 * np.sin(40.0 * run.t))
    rms = rms_of(False, WORLD, biased)
    r = degree(False, WORLD, biased, run)
    assert r == pytest.approx(np.hypot(1.0, rms / WORLD.sensors.force_std), rel=1e-6)
    assert degree(False, WORLD, run, run) == 1.0


def test_degree_of_a_robot_effect_is_relative_to_the_noise_of_eq_1() -> None:
    rng, run, sensors = np.random.default_rng(3), synthetic_run(count=40000), WORLD.sensors
    x = sensors.position_std * rng.standard_normal(len(run.t))
    still = 0.0 * run.x
    F = sensors.force_std * rng.standard_normal(len(run.t))
    noise = rms_of(True, WORLD, Run(run.t, x, still, still, F, still, still, still))
    pushed = Run(run.t, still, still, still, still + 3.0, still, still, still)
    nothing = Run(run.t, *(still for _ in range(7)))
    r = degree(True, WORLD, pushed, nothing)
    assert r == pytest.approx(np.hypot(1.0, 3.0 / noise), rel=0.02)


def test_impedance_residual_is_small_for_the_true_robot_only() -> None:
    own = simulate(WORLD, {}, 500.0)
    other = simulate(WORLD, {'robot_friction.F_c': 6.0}, 500.0)
    assert rms_of(True, WORLD, own) < 0.4
    assert rms_of(True, WORLD, other) > 2.0
    stiff = replace(WORLD, robot=replace(ROBOT, stiffness=5000.0))
    wrong = float(np.sqrt(np.mean((1000.0 * (own.x - own.x_r)) ** 2)))
    assert rms_of(True, stiff, own) == pytest.approx(wrong, rel=0.02)


def test_active_intervals_cover_the_large_residual() -> None:
    t = np.arange(4000) / 500.0
    left = np.where((t > 2.0) & (t < 2.5) | (t > 2.7) & (t < 3.0) | (t > 6.0), 3.0, 0.02)
    left[:100] = np.nan
    (first, second), (third, fourth) = active_intervals(left, t)
    assert (first, second, third) == pytest.approx((2.0, 3.0, 6.0), abs=0.1)
    assert fourth == pytest.approx(t[-1], abs=0.01)
    assert active_intervals(np.full(4000, np.nan), t) == []


def test_search_finds_the_requested_degree() -> None:
    found = conceal(lambda s: float(np.hypot(1.0, 80.0 * s**1.4)), 2.5)
    assert found.degree == pytest.approx(2.5, rel=0.02)
    assert not found.not_concealable


def test_search_returns_the_greatest_strength_of_a_weak_effect() -> None:
    found = conceal(lambda s: float(np.hypot(1.0, 0.5 * s)), 3.0)
    assert (found.strength, found.not_concealable) == (1.0, False)


def test_search_reports_an_effect_that_cannot_be_concealed() -> None:
    assert conceal(lambda s: 40.0 + s, 2.0).not_concealable
    assert conceal(lambda s: 1.0 if s < 1e-3 else 30.0, 2.0).not_concealable


@pytest.mark.slow
def test_trial_has_its_requested_degree() -> None:
    trial = draw_trial('coulomb_friction', np.random.default_rng(4))
    rate = trial.world.sensors.rate
    run = simulate(trial.world, trial.physics, rate)
    r = degree(False, trial.world, run, simulate(trial.world, {}, rate))
    assert MIN_DEGREE <= trial.requested_degree <= MAX_DEGREE
    assert r == pytest.approx(trial.requested_degree, rel=0.1)


@pytest.mark.slow
def test_clean_world_has_no_effect() -> None:
    trial = draw_trial('', np.random.default_rng(4))
    assert (trial.effect, trial.values, trial.physics) == ('', {}, {})


def test_clean_world_obeys_eq_3() -> None:
    run = simulate(WORLD, short_trial().physics, 500.0)
    d = run.x - WALL.location
    wall = np.where(d > 0.0, np.minimum(0.0, -WALL.stiffness * d - WALL.damping * run.v), 0.0)
    assert np.allclose(run.force, wall, atol=1e-9)
    assert np.min(run.force) < -30.0


# -- sensors --------------------------------------------------------------------------------


def test_force_noise_has_the_given_standard_deviation() -> None:
    for distribution in ('normal', 'uniform'):
        sensors = SensorModel(force_noise=0.5, distribution=distribution)
        measured = measure(slow_press(), sensors, np.random.default_rng(0))
        assert measured.force_floor == pytest.approx(0.5, rel=0.05)
        error = measured.force.values + 10.0 * measured.force.stamps * 1e-9
        assert float(np.std(error)) == pytest.approx(measured.force_floor, rel=1e-3)


def test_samples_are_multiples_of_the_quantisation_step() -> None:
    sensors = SensorModel(force_step=0.25, position_step=2e-5)
    measured = measure(slow_press(), sensors, np.random.default_rng(0))
    for values, step in ((measured.force.values, 0.25), (measured.joint.values[:, 0], 2e-5)):
        assert np.allclose(values / step, np.round(values / step), atol=1e-6)


def test_the_anti_alias_filter_does_not_delay_slow_signals() -> None:
    sensors = SensorModel(force_noise=0.0, low_pass=100.0)
    force = measure(slow_press(), sensors, np.random.default_rng(0)).force
    assert np.allclose(force.values[50:], -10e-9 * force.stamps[50:], atol=2e-3)


def test_stamps_jitter_but_increase_and_some_samples_are_dropped() -> None:
    sensors = SensorModel(jitter=4e-5, dropped=0.02)
    force, joint, _, _ = measure(slow_press(), sensors, np.random.default_rng(0))
    steps = np.diff(force.stamps) * 1e-9
    whole = steps[steps < 0.003]
    assert np.min(steps) > 0.0
    assert float(np.std(whole)) == pytest.approx(4e-5 * 2.0**0.5, rel=0.1)
    assert 0.005 < np.mean(steps > 0.003) < 0.04
    assert list(force.stamps) != list(joint.stamps)


def test_joint_samples_between_force_samples_are_stamped_accordingly() -> None:
    sensors = SensorModel(position_noise=0.0, position_step=0.0, joint_phase=0.5)
    joint = measure(slow_press(), sensors, np.random.default_rng(0)).joint
    assert joint.stamps[0] == 1_000_000
    assert np.allclose(joint.values[:, 0], 0.001 * joint.stamps * 1e-9)
